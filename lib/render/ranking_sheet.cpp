#include "render/ranking_sheet.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "geometry/object_files.h"
#include "render/episode_view.h"
#include "render/object_sheet.h"

namespace dexremoe {
namespace {

const ObjectEntry& EntryOf(const RankingSheetInputs& inputs, const std::string& name) {
  for (const ObjectEntry& entry : inputs.entries)
    if (entry.name == name) return entry;
  Fail("ranking: expected the object {} in the list of objects, found none", name);
}

int EpisodeOf(const TraceFile& trace, const std::string& name) {
  for (std::size_t e = 0; e < trace.episodes.size(); ++e)
    if (trace.episodes[e].object == name) return static_cast<int>(e);
  return -1;
}

// "falls after 3.2 s", from the start to the end of the episode.
std::string EndText(const TraceFile& trace, const EpisodeTrace& episode) {
  const double seconds = episode.length() / trace.control_rate;
  if (episode.end == "fall") return fmt::format("falls after {:.1f} s", seconds);
  return fmt::format("{} {:.0f} s", episode.end == "jam" ? "jammed after" : "turns until", seconds);
}

// The step to show: of a fall a moment before its end, when the object is still in sight.
int ShownStep(const TraceFile& trace, const EpisodeTrace& episode) {
  const double before = episode.end == "fall" ? 0.12 : 0;  // s
  return std::max(0, episode.length() - 1 - int(std::lround(before * trace.control_rate)));
}

// Where things stand in a band.
struct Layout {
  int cell, picture, tile;
  double size;  // em of the text
  int heading() const { return int(2.6 * size); }
  int caption() const { return int(4.6 * size); }
  int end_caption() const { return int(3.0 * size); }
  int height() const { return heading() + picture + caption() + tile + end_caption(); }
};

void DrawCell(Renderer& renderer, Canvas& canvas, const RankingSheetInputs& inputs,
              const RankedObject& object, const Layout& layout, int x, int y) {
  const ObjectEntry& entry = EntryOf(inputs, object.name);
  const double size = layout.size, middle = x + layout.cell / 2.0;
  const SheetObject shown = ReadSheetObject(entry, "auto", SheetKind::kMeshes);
  canvas.Paste(x, y, CategoryPicture(renderer, shown, entry.category, layout.cell, layout.picture));
  y += layout.picture;
  const TextStyle faint{0.9 * size, ink::kFaint, Align::kCenter};
  canvas.Text(middle, y + size, SpokenName(object.name), {size, ink::kText, Align::kCenter, true});
  canvas.Text(middle, y + 2.3 * size,
              fmt::format("S {:.2f} [{:.2f}, {:.2f}]", object.successes.value, object.successes.low,
                          object.successes.high),
              {size, ink::kText, Align::kCenter});
  const std::string jams =
      inputs.ranking.jams_known ? fmt::format("{:.0f} %", 100 * object.shares.jam) : "?";
  canvas.Text(middle, y + 3.6 * size,
              fmt::format("falls {:.0f} %, jams {}", 100 * object.shares.fall, jams), faint);
  y += layout.caption();
  const int number = EpisodeOf(inputs.trace, object.name);
  if (number < 0) return canvas.Text(middle, y + layout.tile / 2.0, "no episode recorded", faint);
  renderer.ClearMeshes();
  const TriMesh mesh = ReadObjectMesh(entry.folder + "/mesh.h5").mesh;
  EpisodeView view(renderer, canvas.fonts(), inputs.hand, mesh, inputs.trace, number,
                   inputs.trace_path);
  const int gap = layout.cell / 40;
  canvas.Paste(x + gap, y,
               view.Plain(ShownStep(inputs.trace, inputs.trace.episodes[number]),
                          layout.cell - 2 * gap, layout.tile));
  canvas.Text(middle, y + layout.tile + 1.2 * size,
              EndText(inputs.trace, inputs.trace.episodes[number]), faint);
}

}  // namespace

Image RankingSheet(Renderer& renderer, const Fonts& fonts, const RankingSheetInputs& inputs,
                   int width) {
  const Ranking& ranking = inputs.ranking;
  const int columns = int(std::max<std::size_t>(1, ranking.worst.size()));
  Layout layout{width / columns, 0, 0, 0};
  layout.picture = layout.cell * 4 / 5;
  layout.tile = layout.cell;
  layout.size = std::clamp(layout.cell * 0.065, 8.0, 20.0);
  Image sheet(layout.cell * columns, 2 * layout.height(), 255, 255, 255);
  Canvas canvas(sheet, fonts);
  int y = 0;
  const auto band = [&](const char* word, const std::vector<RankedObject>& objects) {
    canvas.Text(0.6 * layout.size, y + 1.6 * layout.size,
                fmt::format("the {} {} of {}; below each, how a typical episode that it fails ends",
                            objects.size(), word, ranking.policy),
                {1.1 * layout.size, ink::kText, Align::kLeft, true});
    for (std::size_t i = 0; i < objects.size(); ++i)
      DrawCell(renderer, canvas, inputs, objects[i], layout, int(i) * layout.cell,
               y + layout.heading());
    y += layout.height();
  };
  band("worst", ranking.worst);
  band("best", ranking.best);
  return sheet;
}

}  // namespace dexremoe
