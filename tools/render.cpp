// Pictures and films: episodes, strips over time, the hand, objects, convex parts.
#include <algorithm>

#include "base/error.h"
#include "base/log.h"
#include "base/options.h"
#include "geometry/object_files.h"
#include "render/episode_view.h"
#include "render/object_sheet.h"
#include "task/object_set.h"

namespace dexremoe {
namespace {

struct RenderTool {
  std::string kind, out, objects, trace, goal = "beside", up = "auto";
  int width = 0, height = 480, frames = 8, episode = -1, first = 0, last = -1, columns = 0;
  double rate = 30, explode = 0.25;
  bool colliders = false;
  std::vector<int> steps;
  // Holds a ball of 30 mm radius (GX11).
  std::vector<double> q = {1.658, 0.258, 0.177, 0.942,  0.100, 0.514,
                           0.185, 1.554, 0.447, -0.450, 0.153};
  HandOptions hand;
  RenderOptions render;

  void Register(Options& options);
  void RunEpisode() const;
  void RunHand() const;
  void RunSheet() const;
  std::vector<ObjectEntry> Entries() const;
  TriMesh MeshOf(const std::string& object) const;
  int Width(int usual) const { return width > 0 ? width : usual; }
};

void RenderTool::Register(Options& options) {
  options.Add("kind", &kind, "what to draw")
      .Required()
      .Choices({"episode", "strip", "video", "objects", "parts", "hand", "hand_parts"});
  options.Add("out", &out, "PNG file; MP4 for a video").Required().NotStored();
  options.Add("objects", &objects, "objects.csv (all kinds but hand)");
  options.Add("trace", &trace, "recorded episodes (episode, strip, video)");
  options.Add("width", &width, "pixels; 0 takes what suits the kind").Range(0, 16384);
  options.Add("height", &height, "pixels (episode, video, hand)").Range(16, 16384);
  options.Add("episode", &episode, "number within the trace; -1 takes the most successful one");
  options.Add("first", &first, "first control step").Range(0, 1e9);
  options.Add("last", &last, "last control step, at most the episode's; -1 takes the end");
  options.Add("frames", &frames, "pictures of a strip").Range(1, 64);
  options.Add("steps", &steps, "control steps of a strip, or the one of an episode picture");
  options.Add("rate", &rate, "frames per second of a video").Range(1, 240);
  options.Add("goal", &goal, "where the goal is drawn").Choices({"beside", "below", "over"});
  options.Add("columns", &columns, "cells side by side in a sheet; 0 takes 6 (objects), 3 (parts)")
      .Range(0, 64);
  options.Add("up", &up,
              "axis of the objects that stands upright: x, y, z, -x, -y, -z, or auto (from the "
              "meshes' manifest)");
  options.Add("explode", &explode, "how far parts are moved apart, relative").Range(0, 5);
  options.Add("q", &q, "joint angles of the hand picture, rad");
  options.Add("colliders", &colliders, "overlay the hand's collision shapes");
  hand.Register(options);
  render.Register(options);
}

std::vector<ObjectEntry> RenderTool::Entries() const {
  if (objects.empty()) throw UsageError(fmt::format("--kind={} needs --objects=FILE", kind));
  std::vector<ObjectEntry> entries = ReadObjectList(objects);
  if (entries.empty()) Fail("{}: expected objects, found none", objects);
  std::stable_sort(entries.begin(), entries.end(), [](const ObjectEntry& a, const ObjectEntry& b) {
    return a.category < b.category;
  });
  return entries;
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

void RenderTool::RunSheet() const {
  const std::vector<ObjectEntry> entries = Entries();
  const bool with_parts = kind == "parts";
  Progress progress(kind, double(entries.size()));
  const ObjectSource source = [&](int i) {
    progress.Update(i, entries[i].name);
    return ReadSheetObject(entries[i], up, with_parts);
  };
  Renderer renderer(render);
  const Fonts fonts;
  std::vector<std::string> categories;
  for (const ObjectEntry& entry : entries) categories.push_back(entry.category);
  const int count = int(entries.size());
  WritePng(out, with_parts ? PartsSheet(renderer, fonts, count, source, explode,
                                        columns > 0 ? columns : 3, Width(1500))
                           : ObjectSheet(renderer, fonts, categories, source,
                                         columns > 0 ? columns : 6, Width(1440)));
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
    if (tool.kind.starts_with("hand")) return tool.RunHand();
    if (tool.kind == "objects" || tool.kind == "parts") return tool.RunSheet();
    tool.RunEpisode();
  });
}
