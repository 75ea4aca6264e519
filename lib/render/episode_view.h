// Recorded episodes as single pictures, strips over time and films.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "eval/trace.h"
#include "render/canvas.h"
#include "render/hand_scene.h"
#include "render/renderer.h"

namespace dexremoe {

// `number` itself, or with -1 the episode with most successes, the longer one when equal. Throws
// Error naming `trace_path` when there is no such episode.
int PickEpisode(const TraceFile& trace, int number, const std::string& trace_path);

// Control steps outside the episode make the drawing functions throw Error.
class EpisodeView {
 public:
  // `mesh` is the object's, in O at scale 1. All arguments must outlive the view. Throws Error
  // (naming `trace_path`) when the trace was recorded with another hand.
  EpisodeView(Renderer& renderer, const Fonts& fonts, const HandModel& hand, const TriMesh& mesh,
              const TraceFile& trace, int episode, const std::string& trace_path);

  int length() const { return episode_.length(); }
  // One control step with the card of figures.
  Image Picture(int step, int width, int height, GoalPlace place);
  // One control step: hand and object alone.
  Image Plain(int step, int width, int height);
  // The steps side by side, each with its time, angle and weights below. `width` of the whole.
  Image Strip(const std::vector<int>& steps, int width);
  // Steps first .. last at `frames_per_second` of episode time.
  void Film(const std::string& path, int first, int last, int width, int height,
            double frames_per_second, GoalPlace place,
            const std::function<void(int done, int total)>& progress);

 private:
  Image DrawScene(int step, int width, int height, GoalPlace place, bool label);
  void DrawStripCaption(Canvas& canvas, int step, double x, double width, double y) const;
  double Time(int step) const { return step / trace_.control_rate; }
  void CheckStep(int step) const;
  int SuccessesUntil(int step) const;  // goals reached by steps before this one
  bool JustReached(int step) const;
  std::vector<float> Weights(int step) const;

  Renderer& renderer_;
  const Fonts& fonts_;
  const TraceFile& trace_;
  const int number_;
  const EpisodeTrace& episode_;
  const std::string trace_path_;
  int joints_ = 0;
  HandScene hand_;
  int object_ = 0;  // mesh
};

// `count` steps evenly over first .. last, both included.
std::vector<int> SpreadSteps(int first, int last, int count);

// Edges that turn by more than this are drawn sharp: grown things are smooth, made things are not.
double CreaseOf(const std::string& category);

// A name as captions show it: "old_van" becomes "old van".
std::string SpokenName(std::string name);

}  // namespace dexremoe
