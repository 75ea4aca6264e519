#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <sstream>

#include "geometry/pose.h"
#include "geometry/recipes.h"
#include "io/atomic_file.h"

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

// From the world to each of the copies that `repeat` asks for.
std::vector<Eigen::Isometry3d> Copies(RecipeArgs& args) {
  const double repeat = args.Number("repeat", 1);
  if (!(repeat >= 1) || repeat > 1000 || repeat != std::floor(repeat))
    args.place().Fail("repeat: expected a whole number in 1..1000, found {}", repeat);
  const int count = static_cast<int>(repeat), around = args.Axis("around");
  const Vector3d step =
      count > 1 && around < 0 ? args.Vector("step") : args.Vector("step", Vector3d::Zero());
  std::vector<Eigen::Isometry3d> copies(count, Eigen::Isometry3d::Identity());
  for (int i = 0; i < count; ++i) {
    if (around >= 0)
      copies[i].rotate(
          Eigen::AngleAxisd(-2 * std::numbers::pi * i / count, Vector3d::Unit(around)));
    copies[i].translate(-i * step);
  }
  return copies;
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
  const int mirror = args.Axis("mirror");
  return [=, field = std::move(field), copies = Copies(args),
          least = scale.minCoeff()](const Vector3d& world) {
    Vector3d p = world;
    if (mirror >= 0) p[mirror] = std::abs(p[mirror]);
    double distance = INFINITY;
    for (const Eigen::Isometry3d& copy : copies)
      distance = std::min(distance, field(inverse * (copy * p - at)) * least);
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

void ReadHeadLine(RecipeLine& line, const std::string& word, RecipeHead& head) {
  if (word == "class") {
    head.object_class = line.Word("a name");
    return line.ExpectEnd();
  }
  while (!line.AtEnd()) head.variants.push_back(line.Word("a name"));
  if (head.variants.empty()) line.place().Fail("variants: expected names, found none");
}

class Parser {
 public:
  Parser(const RecipeHead& head, const std::string& variant, std::uint64_t seed)
      : head_lines_(head.lines) {
    scope_.rng = Rng(seed, Stream::kRecipe);
    scope_.variants = std::max<std::size_t>(head.variants.size(), 1);
    for (std::size_t i = 0; i < head.variants.size(); ++i) {
      const bool ours = variant.empty() ? i == 0 : head.variants[i] == variant;
      if (ours) scope_.variant = i;
      scope_.names[head.variants[i]] = ours ? 1 : 0;
    }
  }

  Recipe Run(const std::string& file, const std::string& text) {
    groups_.push_back({{}, Operation::kAdd, RecipeArgs({file, 1})});
    ReadLines(file, text, head_lines_);
    if (groups_.size() > 1)
      groups_.back().args.place().Fail("group: expected 'end', found the end of the file");
    if (groups_[0].steps.empty())
      RecipePlace{file, 1}.Fail("expected at least one shape, found none");
    recipe_.field = Combined(std::move(groups_[0].steps));
    return std::move(recipe_);
  }

 private:
  struct Group {
    std::vector<Step> steps;
    Operation operation;
    RecipeArgs args;
  };

  void ReadLines(const std::string& file, const std::string& text, int skip) {
    std::istringstream lines(text);
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
      if (++number <= skip) continue;
      RecipeLine reader({file, number}, line, scope_);
      if (!reader.AtEnd()) Statement(reader);
    }
  }

  void Statement(RecipeLine& line) {
    const std::string word = line.Word("a statement");
    if (word == "let") return Let(line);
    if (word == "include") return Include(line);
    if (word == "resolution") return void(recipe_.resolution = Count(line, word, 16, 256));
    if (word == "triangles") return void(recipe_.triangles = Count(line, word, 500, 100000));
    if (word == "end") return End(line);
    if (word == "add") return Shape(Operation::kAdd, line);
    if (word == "cut") return Shape(Operation::kCut, line);
    if (word == "keep") return Shape(Operation::kKeep, line);
    line.place().Fail(
        "expected let, include, triangles, resolution, add, cut, keep or end; found '{}'", word);
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

  void Include(RecipeLine& line) {
    constexpr int kDeepest = 8;
    const std::string name = line.Rest();
    const auto path = std::filesystem::path(line.place().file).parent_path() / name;
    if (!std::filesystem::is_regular_file(path))
      line.place().Fail("include: expected a file, found none at '{}'", path.string());
    if (++depth_ > kDeepest)
      line.place().Fail("include: expected at most {} files within each other, found more",
                        kDeepest);
    const std::size_t open = groups_.size();
    ReadLines(path.string(), ReadFile(path.string()), 0);
    if (groups_.size() != open)
      line.place().Fail("include: expected as many 'group' as 'end' in {}, found {} more of one",
                        name, std::max(groups_.size(), open) - std::min(groups_.size(), open));
    --depth_;
  }

  static int Count(RecipeLine& line, const std::string& what, double low, double high) {
    const double value = line.Expression();
    line.ExpectEnd();
    if (!(value >= low && value <= high))
      line.place().Fail("{}: expected {} to {}, found {}", what, low, high, value);
    return static_cast<int>(value);
  }

  void Shape(Operation operation, RecipeLine& line) {
    const std::string name = line.Word("a shape or group");
    RecipeArgs args = line.Arguments();
    if (name == "group") {
      groups_.push_back({{}, operation, std::move(args)});
      return;
    }
    if (args.Number("when", 1) == 0) return;
    Field field = MakeShape(name, args);
    Finish(operation, std::move(field), args, name);
  }

  void End(RecipeLine& line) {
    line.ExpectEnd();
    if (groups_.size() == 1) line.place().Fail("expected a statement, found 'end' without a group");
    Group group = std::move(groups_.back());
    groups_.pop_back();
    if (group.args.Number("when", 1) == 0) return;
    if (group.steps.empty()) line.place().Fail("expected a shape in the group, found none");
    Finish(group.operation, Combined(std::move(group.steps)), group.args, "group");
  }

  void Finish(Operation operation, Field field, RecipeArgs& args, const std::string& name) {
    if (groups_.back().steps.empty() && operation != Operation::kAdd)
      args.place().Fail("expected 'add' first, found something to take away from nothing");
    const double smooth = args.Number("smooth", 0);
    field = Placed(std::move(field), args);
    args.Finish(name);
    groups_.back().steps.push_back({operation, std::move(field), smooth});
  }

  int head_lines_, depth_ = 0;
  RecipeScope scope_;
  std::vector<Group> groups_;
  Recipe recipe_;
};

}  // namespace

RecipeHead ReadRecipeHead(const std::string& file, const std::string& text) {
  RecipeHead head;
  RecipeScope scope;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    RecipeLine reader({file, ++number}, line, scope);
    if (reader.AtEnd()) continue;
    const std::string word = reader.Word("a statement");
    if (word != "class" && word != "variants") break;
    ReadHeadLine(reader, word, head);
    head.lines = number;
  }
  return head;
}

Recipe ParseRecipe(const std::string& file, const std::string& text, std::uint64_t seed,
                   const std::string& variant) {
  return Parser(ReadRecipeHead(file, text), variant, seed).Run(file, text);
}

}  // namespace dexremoe
