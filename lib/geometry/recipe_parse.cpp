#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "geometry/pose.h"
#include "geometry/recipes.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;

// Turns the sections of a shape along x. Approximate: lengths off the x axis change.
Field Bent(Field field, double degrees) {
  return [field = std::move(field), k = degrees * std::numbers::pi / 180](const Vector3d& p) {
    const double c = std::cos(k * p.x()), s = std::sin(k * p.x());
    return field({c * p.x() + s * p.z(), p.y(), c * p.z() - s * p.x()});
  };
}

Field Tapered(Field field, const std::vector<double>& taper) {
  const double x0 = taper[0], x1 = taper[1], s0 = taper[2], s1 = taper[3];
  return [=, field = std::move(field)](const Vector3d& p) {
    const double t = std::clamp((p.x() - x0) / (x1 - x0), 0.0, 1.0), s = s0 + t * (s1 - s0);
    return field({p.x(), p.y() / s, p.z() / s}) * std::min(s, 1.0);
  };
}

// What `repeat`, `at`, `turn` and `scale` ask for; mirroring comes outermost.
Field Placed(Field field, RecipeArgs& args) {
  if (args.Has("taper")) {
    const auto taper = args.List("taper", 1, 4, 4).front();
    if (taper[0] == taper[1] || !(std::min(taper[2], taper[3]) > 0))
      args.place().Fail("taper: expected (x0,x1,s0,s1) with x0 other than x1 and scales above 0");
    field = Tapered(std::move(field), taper);
  }
  if (args.Has("bend")) field = Bent(std::move(field), args.Number("bend"));
  const Vector3d at = args.Vector("at", Vector3d::Zero());
  const Vector3d turn = args.Vector("turn", Vector3d::Zero()) * std::numbers::pi / 180;
  const Vector3d scale = args.Spread("scale", Vector3d::Ones());
  if (!(scale.minCoeff() > 0))
    args.place().Fail("scale: expected above 0, found {}", scale.minCoeff());
  const Eigen::Matrix3d inverse =
      scale.cwiseInverse().asDiagonal() *
      QuaternionFromRpy(turn.x(), turn.y(), turn.z()).toRotationMatrix().transpose();
  const double repeat = args.Number("repeat", 1);
  if (!(repeat >= 1) || repeat > 1000 || repeat != std::floor(repeat))
    args.place().Fail("repeat: expected a whole number in 1..1000, found {}", repeat);
  const Vector3d step = repeat > 1 ? args.Vector("step") : Vector3d::Zero();
  const int axis = args.Axis("mirror");
  return [=, field = std::move(field), least = scale.minCoeff()](const Vector3d& world) {
    Vector3d p = world;
    if (axis >= 0) p[axis] = std::abs(p[axis]);
    double distance = INFINITY;
    for (int i = 0; i < static_cast<int>(repeat); ++i)
      distance = std::min(distance, field(inverse * (p - at - i * step)) * least);
    return distance;
  };
}

enum class Operation { kAdd, kCut, kKeep };

struct Step {
  Operation operation = Operation::kAdd;
  Field field;
  double smooth = 0;
};

// The steps of a group, applied in order.
Field Combined(std::vector<Step> steps) {
  return [steps = std::move(steps)](const Vector3d& p) {
    double value = INFINITY;
    for (const Step& step : steps) {
      const double other = step.field(p);
      switch (step.operation) {
        case Operation::kAdd:
          value = SmoothMin(value, other, step.smooth);
          break;
        case Operation::kCut:
          value = -SmoothMin(-value, other, step.smooth);
          break;
        case Operation::kKeep:
          value = -SmoothMin(-value, -other, step.smooth);
          break;
      }
    }
    return value;
  };
}

class Parser {
 public:
  Parser(std::string file, std::uint64_t seed) : file_(std::move(file)) {
    scope_.rng = Rng(seed, Stream::kRecipe);
  }

  Recipe Run(const std::string& text) {
    groups_.push_back({{}, Operation::kAdd, RecipeArgs(Place())});
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      ++line_;
      RecipeLine reader(Place(), line, scope_);
      if (!reader.AtEnd()) Statement(reader);
    }
    if (groups_.size() > 1)
      groups_.back().args.place().Fail("group: expected 'end', found the end of the file");
    if (groups_[0].steps.empty()) Place().Fail("expected at least one shape, found none");
    recipe_.field = Combined(std::move(groups_[0].steps));
    return std::move(recipe_);
  }

 private:
  struct Group {
    std::vector<Step> steps;
    Operation operation;
    RecipeArgs args;
  };

  RecipePlace Place() const { return {file_, line_}; }

  void Statement(RecipeLine& line) {
    const std::string word = line.Word("a statement");
    if (word == "let") return Let(line);
    if (word == "resolution") return Resolution(line);
    if (word == "end") return End(line);
    if (word == "add") return Shape(Operation::kAdd, line);
    if (word == "cut") return Shape(Operation::kCut, line);
    if (word == "keep") return Shape(Operation::kKeep, line);
    line.place().Fail("expected let, resolution, add, cut, keep or end; found '{}'", word);
  }

  void Let(RecipeLine& line) {
    const std::string name = line.Word("a name");
    line.Expect('=');
    const double value = line.Expression();
    line.ExpectEnd();
    if (!std::isfinite(value))
      line.place().Fail("{}: expected a finite number, found {}", name, value);
    scope_.names[name] = value;
  }

  void Resolution(RecipeLine& line) {
    const double value = line.Expression();
    line.ExpectEnd();
    if (!(value >= 16 && value <= 256))
      line.place().Fail("resolution: expected 16 to 256, found {}", value);
    recipe_.resolution = static_cast<int>(value);
  }

  void Shape(Operation operation, RecipeLine& line) {
    if (groups_.back().steps.empty() && operation != Operation::kAdd)
      line.place().Fail("expected 'add' first, found something to take away from nothing");
    const std::string name = line.Word("a shape or group");
    RecipeArgs args = line.Arguments();
    if (name == "group") {
      groups_.push_back({{}, operation, std::move(args)});
      return;
    }
    Field field = MakeShape(name, args);
    Finish(operation, std::move(field), args, name);
  }

  void End(RecipeLine& line) {
    line.ExpectEnd();
    if (groups_.size() == 1) line.place().Fail("expected a statement, found 'end' without a group");
    Group group = std::move(groups_.back());
    groups_.pop_back();
    if (group.steps.empty()) line.place().Fail("expected a shape in the group, found none");
    Finish(group.operation, Combined(std::move(group.steps)), group.args, "group");
  }

  void Finish(Operation operation, Field field, RecipeArgs& args, const std::string& name) {
    const double smooth = args.Number("smooth", 0);
    field = Placed(std::move(field), args);
    args.Finish(name);
    groups_.back().steps.push_back({operation, std::move(field), smooth});
  }

  std::string file_;
  int line_ = 0;
  RecipeScope scope_;
  std::vector<Group> groups_;
  Recipe recipe_;
};

}  // namespace

Recipe ParseRecipe(const std::string& file, const std::string& text, std::uint64_t seed) {
  return Parser(file, seed).Run(text);
}

}  // namespace dexremoe
