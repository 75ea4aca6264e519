// Pictures and films: episodes, strips over time, the hand, objects, convex parts.
#include <algorithm>

#include "base/error.h"
#include "base/log.h"
#include "base/options.h"
#include "geometry/object_files.h"
#include "render/episode_view.h"
#include "render/gallery.h"
#include "task/object_set.h"

namespace dexremoe {
namespace {

struct RenderTool {
  std::string kind, out, objects, object, trace, goal = "beside";
  int height = 480, frames = 8, episode = -1, first = 0, last = -1;
  double rate = 30;
  bool colliders = false;
  std::vector<int> steps;
  // Holds a ball of 30 mm radius (GX11).
  std::vector<double> q = {1.658, 0.258, 0.177, 0.942,  0.100, 0.514,
                           0.185, 1.554, 0.447, -0.450, 0.153};
  HandOptions hand;
  RenderOptions render;
  SheetOptions sheet;

  void Register(Options& options);
  void RunEpisode() const;
  void RunHand() const;
  void RunObject() const;
  void RunSheets() const;
  std::vector<ObjectEntry> Entries() const;
  TriMesh MeshOf(const std::string& object) const;
  int Width(int usual) const { return sheet.width > 0 ? sheet.width : usual; }
};

void RenderTool::Register(Options& options) {
  options.Add("kind", &kind, "what to draw; sources and dataset: meshes as they come")
      .Required()
      .Choices({"episode", "strip", "video", "object", "objects", "sources", "dataset", "parts",
                "clouds", "gallery", "hand", "hand_parts"});
  options.Add("out", &out, "PNG file; MP4 for a video; folder for a gallery")
      .Required()
      .NotStored();
  options.Add("objects", &objects, "objects.csv (all kinds but object and hand)");
  options.Add("object", &object, "mesh file, mesh.h5, parts.h5 or cloud.h5 (object)");
  options.Add("trace", &trace, "recorded episodes (episode, strip, video)");
  options.Add("width", &sheet.width, "pixels; 0 takes what suits the kind").Range(0, 16384);
  options.Add("height", &height, "pixels (episode, video, object, hand)").Range(16, 16384);
  options.Add("episode", &episode, "number within the trace; -1 takes the most successful one");
  options.Add("first", &first, "first control step").Range(0, 1e9);
  options.Add("last", &last, "last control step, at most the episode's; -1 takes the end");
  options.Add("frames", &frames, "pictures of a strip").Range(1, 64);
  options.Add("steps", &steps, "control steps of a strip, or the one of an episode picture");
  options.Add("rate", &rate, "frames per second of a video").Range(1, 240);
  options.Add("goal", &goal, "where the goal is drawn").Choices({"beside", "below", "over"});
  options.Add("q", &q, "joint angles of the hand picture, rad");
  options.Add("colliders", &colliders, "overlay the hand's collision shapes");
  hand.Register(options);
  render.Register(options);
  sheet.Register(options);
}

std::vector<ObjectEntry> RenderTool::Entries() const {
  if (objects.empty()) throw UsageError(fmt::format("--kind={} needs --objects=FILE", kind));
  return ReadObjectList(objects);
}

// The mesh of the object that an episode shows.
TriMesh RenderTool::MeshOf(const std::string& object) const {
  for (const ObjectEntry& entry : Entries())
    if (entry.name == object) return ReadObjectMesh(entry.folder + "/mesh.h5").mesh;
  Fail("{}: expected the object {} of {}, found none", objects, object, trace);
}

void RenderTool::RunEpisode() const {
  if (trace.empty()) throw UsageError(fmt::format("--kind={} needs --trace=FILE", kind));
  const TraceFile file = ReadTrace(trace);
  const int number = PickEpisode(file, episode, trace);
  const TriMesh mesh = MeshOf(file.episodes[number].object);
  const HandModel model = LoadHand(hand);
  RenderOptions quality = render;
  if (kind == "video") quality.supersample = render.film_supersample;
  Renderer renderer(quality);
  const Fonts fonts;
  EpisodeView view(renderer, fonts, model, mesh, file, number, trace);
  const int end = last < 0 ? view.length() - 1 : std::min(last, view.length() - 1);
  if (kind == "video") {
    Progress progress("video", 1);
    view.Film(out, first, end, Width(640), height, rate, PlaceNamed(goal),
              [&](int done, int total) {
                progress.Update(double(done) / total, fmt::format("{} of {} frames", done, total));
              });
    progress.Finish();
  } else if (kind == "strip") {
    WritePng(out, view.Strip(steps.empty() ? SpreadSteps(first, end, frames) : steps, Width(2000)));
  } else {
    WritePng(out,
             view.Picture(steps.empty() ? first : steps[0], Width(640), height, PlaceNamed(goal)));
  }
}

void RenderTool::RunHand() const {
  const HandModel model = LoadHand(hand);
  Renderer renderer(render);
  WritePng(out, kind == "hand" ? HandPicture(renderer, model, q, colliders, Width(640), height)
                               : HandPartsPicture(renderer, model, q, Width(1200), height));
}

void RenderTool::RunObject() const {
  if (object.empty()) throw UsageError("--kind=object needs --object=FILE");
  const SheetObject shown = ReadSheetFile(object, sheet.up);
  Renderer renderer(render);
  WritePng(out, ObjectPicture(renderer, shown, sheet.explode, Width(640), height));
}

void RenderTool::RunSheets() const {
  const std::vector<ObjectEntry> entries = ByCategory(Entries());
  Progress progress(kind, double(entries.size()) * (kind == "gallery" ? 3 : 1));
  const SheetProgress show = [&](int done, const std::string& name) {
    progress.Update(done, name);
  };
  Renderer renderer(render);
  const Fonts fonts;
  if (kind == "gallery")
    DrawGallery(renderer, fonts, entries, sheet, out, show);
  else
    WritePng(out, DrawSheet(renderer, fonts, SheetKindNamed(kind), entries, sheet, show));
  progress.Finish();
}

}  // namespace
}  // namespace dexremoe

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("render", "Draws pictures and films of episodes, objects, parts and the hand.",
                  "render --kind=strip --trace=results/quick/trace/gate.h5 "
                  "--objects=results/quick/objects.csv --out=strip.png");
  RenderTool tool;
  tool.Register(options);
  return RunTool(options, argc, argv, [&] {
    if (tool.kind == "hand" || tool.kind == "hand_parts") return tool.RunHand();
    if (tool.kind == "object") return tool.RunObject();
    if (tool.kind == "episode" || tool.kind == "strip" || tool.kind == "video")
      return tool.RunEpisode();
    tool.RunSheets();
  });
}
