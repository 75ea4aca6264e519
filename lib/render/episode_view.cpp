#include "render/episode_view.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "render/episode_panel.h"
#include "render/video.h"

namespace dexremoe {
namespace {

Pose PoseAt(const std::vector<double>& position, const std::vector<double>& rotation, int step) {
  const double* p = position.data() + 3 * step;
  const double* q = rotation.data() + 4 * step;
  return {Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized(),
          Eigen::Vector3d(p[0], p[1], p[2])};
}

}  // namespace

int PickEpisode(const TraceFile& trace, int number, const std::string& trace_path) {
  const int count = int(trace.episodes.size());
  if (count == 0) Fail("{}: expected episodes, found none", trace_path);
  if (number < -1 || number >= count)
    Fail("{}: expected an episode within 0..{}, found {}", trace_path, count - 1, number);
  if (number >= 0) return number;
  const auto worse = [](const EpisodeTrace& a, const EpisodeTrace& b) {
    return std::pair(a.successes, a.length()) < std::pair(b.successes, b.length());
  };
  return int(std::max_element(trace.episodes.begin(), trace.episodes.end(), worse) -
             trace.episodes.begin());
}

std::vector<int> SpreadSteps(int first, int last, int count) {
  std::vector<int> steps;
  for (int i = 0; i < count; ++i)
    steps.push_back(count == 1 ? first
                               : int(std::lround(first + double(last - first) * i / (count - 1))));
  return steps;
}

double CreaseOf(const std::string& category) {
  return category == "animal" || category == "head" || category == "shoe" ? 1.2 : 0.6;
}

EpisodeView::EpisodeView(Renderer& renderer, const Fonts& fonts, const HandModel& hand,
                         const TriMesh& mesh, const TraceFile& trace, int episode,
                         const std::string& trace_path)
    : renderer_(renderer),
      fonts_(fonts),
      trace_(trace),
      number_(episode),
      episode_(trace.episodes.at(episode)),
      trace_path_(trace_path),
      joints_(hand.num_joints()),
      hand_(renderer, hand) {
  for (int j = 0; j < joints_ || j < int(trace.joint_names.size()); ++j) {
    const std::string expected = j < joints_ ? hand.joints[j].name : "none";
    const std::string found = j < int(trace.joint_names.size()) ? trace.joint_names[j] : "none";
    if (expected != found)
      Fail("{}: joint {}: expected {} as in {}, found {}", trace_path, j, expected, hand.source,
           found);
  }
  if (episode_.length() == 0)
    Fail("{}: episode {}: expected steps, found none", trace_path, episode);
  object_ = renderer.AddMesh(mesh, CreaseOf(episode_.category));
}

void EpisodeView::CheckStep(int step) const {
  if (step < 0 || step >= length())
    Fail("{}: episode {}: expected a step within 0..{}, found {}", trace_path_, number_,
         length() - 1, step);
}

int EpisodeView::SuccessesUntil(int step) const {
  return int(std::count_if(episode_.success.begin(), episode_.success.begin() + step,
                           [](std::uint8_t s) { return s != 0; }));
}

// Within the last third of a second: long enough to be seen in a film.
bool EpisodeView::JustReached(int step) const {
  const int before = std::max(0, step - int(std::lround(trace_.control_rate / 3)));
  return SuccessesUntil(step) > SuccessesUntil(before);
}

std::vector<float> EpisodeView::Weights(int step) const {
  const std::size_t experts = trace_.expert_names.size();
  if (experts == 0 || episode_.gate.empty()) return {};
  const auto row = episode_.gate.begin() + std::ptrdiff_t(experts) * step;
  return {row, row + std::ptrdiff_t(experts)};
}

Image EpisodeView::DrawScene(int step, int width, int height, GoalPlace place, bool label) {
  CheckStep(step);
  Scene scene;
  hand_.Add(episode_.joint_position.data() + std::ptrdiff_t(joints_) * step, scene);
  const Camera camera = HandCamera(place, double(width) / height);
  Item object{object_, PoseAt(episode_.object_position, episode_.object_rotation, step),
              episode_.scale, palette::kObject};
  Item goal{object_, PoseAt(episode_.object_position, episode_.goal_rotation, step), episode_.scale,
            palette::kGoal};
  // Beside the hand the ghost stands still, at the place of the first step.
  if (place != GoalPlace::kOver)
    goal.X_WM.p = PoseAt(episode_.object_position, episode_.object_rotation, 0).p;
  goal.X_WM.p += GoalOffset(place, camera);
  scene.items.push_back(object);
  if (place != GoalPlace::kNone) scene.items.push_back(goal);
  Image image = renderer_.Draw(scene, camera, width, height);
  if (label && place != GoalPlace::kOver) {
    const Sphere bounds = renderer_.Bounds(goal);
    const Eigen::Vector3d below = bounds.center - 0.85 * bounds.radius * camera.Axes().col(1);
    const Eigen::Vector3d at = camera.Project(below, width, height);
    const double size = 13.0 * height / 480;
    Canvas canvas(image, fonts_);
    canvas.Text(at.x(), std::min(at.y() + size, height - 0.5 * size), "goal",
                {size, ink::kGood, Align::kCenter});
  }
  return image;
}

std::string SpokenName(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

Image EpisodeView::Picture(int step, int width, int height, GoalPlace place) {
  Image image = DrawScene(step, width, height, place, true);
  PanelData panel;
  panel.title = SpokenName(episode_.object);
  panel.subtitle = episode_.category;
  panel.time = Time(step);
  panel.angle = episode_.angle[step];
  panel.tolerance = trace_.tolerance;
  panel.successes = SuccessesUntil(step);
  panel.just_reached = JustReached(step);
  panel.experts = trace_.expert_names;
  panel.weights = Weights(step);
  Canvas canvas(image, fonts_);
  DrawPanel(canvas, panel, std::min(height / 480.0, width / 640.0));
  return image;
}

void EpisodeView::DrawStripCaption(Canvas& canvas, int step, double x, double width,
                                   double y) const {
  const double size = width * 0.075, middle = x + width / 2;
  const bool close = episode_.angle[step] <= trace_.tolerance;
  canvas.Text(middle, y + 1.3 * size, fmt::format("{:.2f} s", Time(step)),
              {size, ink::kText, Align::kCenter, true});
  canvas.Text(middle, y + 2.6 * size,
              fmt::format("{:.2f} rad, {} done", episode_.angle[step], SuccessesUntil(step)),
              {0.85 * size, close ? ink::kGood : ink::kFaint, Align::kCenter});
  DrawStackedWeights(canvas, x + 0.08 * width, y + 3.2 * size, 0.84 * width, 0.6 * size,
                     Weights(step));
}

Image EpisodeView::Plain(int step, int width, int height) {
  return DrawScene(step, width, height, GoalPlace::kNone, false);
}

Image EpisodeView::Strip(const std::vector<int>& steps, int width) {
  const int count = int(steps.size()), gap = std::max(2, width / 400);
  const int cell = (width - (count - 1) * gap) / count, picture = cell * 3 / 2;
  const double size = cell * 0.075;
  const bool gate = !Weights(0).empty();
  const int top = int(2.2 * size);
  const int height = top + picture + int((gate ? 6.6 : 3.4) * size);
  Image sheet(count * cell + (count - 1) * gap, height, 255, 255, 255);
  Canvas canvas(sheet, fonts_);
  canvas.Text(0.3 * size, 1.4 * size, SpokenName(episode_.object),
              {1.1 * size, ink::kText, Align::kLeft, true});
  canvas.Text(sheet.width - 0.3 * size, 1.4 * size,
              fmt::format("orange: object, green: goal; {} goals reached in {:.1f} s",
                          episode_.successes, Time(length())),
              {0.9 * size, ink::kFaint, Align::kRight});
  for (int i = 0; i < count; ++i) {
    const int x = i * (cell + gap);
    canvas.Paste(x, top, DrawScene(steps[i], cell, picture, GoalPlace::kBelow, false));
    DrawStripCaption(canvas, steps[i], x, cell, top + picture);
  }
  if (gate)
    DrawLegend(canvas, sheet.width / 2.0, height - 0.7 * size, trace_.expert_names, 0.9 * size);
  return sheet;
}

void EpisodeView::Film(const std::string& path, int first, int last, int width, int height,
                       double frames_per_second, GoalPlace place,
                       const std::function<void(int, int)>& progress) {
  CheckStep(first);
  CheckStep(last);
  VideoWriter video(path, width, height, frames_per_second);
  const double stride = trace_.control_rate / frames_per_second;
  const int frames = 1 + std::max(0, int((last - first) / stride));
  for (int f = 0; f < frames; ++f) {
    video.Add(Picture(first + int(std::lround(f * stride)), width, height, place));
    progress(f + 1, frames);
  }
  video.Finish();
}

}  // namespace dexremoe
