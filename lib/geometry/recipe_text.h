// The words of a recipe file: lines, arguments and arithmetic. See recipes.h for the language.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/random.h"

namespace dexremoe {

// What expressions may use: names set by `let`, random numbers in file order, the variant.
struct RecipeScope {
  std::map<std::string, double> names;
  Rng rng{0};
  std::size_t variant = 0, variants = 1;
};

// Where in which file, for messages.
struct RecipePlace {
  std::string file;
  int line = 0;
  template <typename... Args>
  [[noreturn]] void Fail(fmt::format_string<Args...> format, Args&&... args) const {
    dexremoe::Fail("{}:{}: {}", file, line, fmt::format(format, std::forward<Args>(args)...));
  }
};

// The key=value arguments of a line. Each is asked for by name; what nobody asked for is an error.
class RecipeArgs {
 public:
  using Tuple = std::vector<double>;

  explicit RecipeArgs(RecipePlace place) : place_(std::move(place)) {}
  const RecipePlace& place() const { return place_; }
  bool Has(const std::string& key) const { return values_.count(key) > 0; }

  double Number(const std::string& key, std::optional<double> otherwise = std::nullopt);
  // Like Number; throws unless the value exceeds zero.
  double Positive(const std::string& key, std::optional<double> otherwise = std::nullopt);
  Eigen::Vector3d Vector(const std::string& key,
                         std::optional<Eigen::Vector3d> otherwise = std::nullopt);
  // A number stands for two or three equal ones.
  Eigen::Vector2d Pair(const std::string& key,
                       std::optional<Eigen::Vector2d> otherwise = std::nullopt);
  Eigen::Vector3d Spread(const std::string& key,
                         std::optional<Eigen::Vector3d> otherwise = std::nullopt);
  // At least `least` tuples of `low` to `high` numbers.
  std::vector<Tuple> List(const std::string& key, std::size_t least, std::size_t low,
                          std::size_t high);
  // One of x, y, z as 0, 1, 2; -1 when absent.
  int Axis(const std::string& key);

  // Throws when an argument was not asked for; `what` is the word it stands behind.
  void Finish(const std::string& what) const;

 private:
  friend class RecipeLine;
  struct Value {
    std::vector<Tuple> tuples;
    std::string word;
    bool used = false;
  };
  // Null when absent and not needed.
  const Value* Find(const std::string& key, bool needed);
  const Tuple* Single(const std::string& key, bool needed, std::size_t low, std::size_t high);

  RecipePlace place_;
  std::map<std::string, Value> values_;
};

// Reads one line from left to right.
class RecipeLine {
 public:
  RecipeLine(RecipePlace place, std::string text, RecipeScope& scope);

  bool AtEnd();
  std::string Word(const char* what);
  std::string Rest();  // of the line, without blanks around it
  void Expect(char c);
  double Expression();
  RecipeArgs Arguments();
  void ExpectEnd();
  const RecipePlace& place() const { return place_; }

 private:
  void SkipSpace();
  bool Accept(char c);
  char Peek();
  double Term();
  double Factor();
  double Function(const std::string& name);
  double Literal();
  RecipeArgs::Tuple TupleOrNumber();

  RecipePlace place_;
  std::string text_;
  std::size_t at_ = 0;
  RecipeScope& scope_;
};

}  // namespace dexremoe
