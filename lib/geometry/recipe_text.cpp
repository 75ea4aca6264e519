#include "geometry/recipe_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

namespace dexremoe {
namespace {

bool IsWordStart(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool IsWordPart(char c) {
  return IsWordStart(c) || std::isdigit(static_cast<unsigned char>(c)) != 0;
}

}  // namespace

const RecipeArgs::Value* RecipeArgs::Find(const std::string& key, bool needed) {
  const auto found = values_.find(key);
  if (found != values_.end()) {
    found->second.used = true;
    return &found->second;
  }
  if (needed) place_.Fail("expected '{}=', found none", key);
  return nullptr;
}

const RecipeArgs::Tuple* RecipeArgs::Single(const std::string& key, bool needed, std::size_t low,
                                            std::size_t high) {
  const Value* value = Find(key, needed);
  if (value == nullptr) return nullptr;
  if (value->tuples.size() != 1 || value->tuples[0].size() < low || value->tuples[0].size() > high)
    place_.Fail("{}: expected {} number(s), found {}", key,
                low == high ? fmt::format("{}", low) : fmt::format("{} or {}", low, high),
                value->tuples.size() == 1 ? fmt::format("{}", value->tuples[0].size())
                                          : fmt::format("a list of {}", value->tuples.size()));
  return &value->tuples[0];
}

double RecipeArgs::Number(const std::string& key, std::optional<double> otherwise) {
  const Tuple* tuple = Single(key, !otherwise, 1, 1);
  return tuple != nullptr ? tuple->front() : *otherwise;
}

double RecipeArgs::Positive(const std::string& key, std::optional<double> otherwise) {
  const double value = Number(key, otherwise);
  if (!(value > 0)) place_.Fail("{}: expected more than 0, found {}", key, value);
  return value;
}

Eigen::Vector3d RecipeArgs::Vector(const std::string& key,
                                   std::optional<Eigen::Vector3d> otherwise) {
  const Tuple* tuple = Single(key, !otherwise, 3, 3);
  return tuple != nullptr ? Eigen::Vector3d(tuple->data()) : *otherwise;
}

Eigen::Vector2d RecipeArgs::Pair(const std::string& key, std::optional<Eigen::Vector2d> otherwise) {
  const Tuple* tuple = Single(key, !otherwise, 1, 2);
  return tuple != nullptr ? Eigen::Vector2d(tuple->front(), tuple->back()) : *otherwise;
}

Eigen::Vector3d RecipeArgs::Spread(const std::string& key,
                                   std::optional<Eigen::Vector3d> otherwise) {
  const Tuple* tuple = Single(key, !otherwise, 1, 3);
  if (tuple == nullptr) return *otherwise;
  if (tuple->size() == 2) place_.Fail("{}: expected 1 or 3 number(s), found 2", key);
  return tuple->size() == 1 ? Eigen::Vector3d::Constant(tuple->front())
                            : Eigen::Vector3d(tuple->data());
}

std::vector<RecipeArgs::Tuple> RecipeArgs::List(const std::string& key, std::size_t least,
                                                std::size_t low, std::size_t high) {
  const Value& value = *Find(key, true);
  if (value.tuples.size() < least)
    place_.Fail("{}: expected at least {} tuples, found {}", key, least, value.tuples.size());
  for (const Tuple& tuple : value.tuples)
    if (tuple.size() < low || tuple.size() > high)
      place_.Fail("{}: expected tuples of {} to {} numbers, found {}", key, low, high,
                  tuple.size());
  return value.tuples;
}

int RecipeArgs::Axis(const std::string& key) {
  const Value* value = Find(key, false);
  if (value == nullptr) return -1;
  if (value->word != "x" && value->word != "y" && value->word != "z")
    place_.Fail("{}: expected x, y or z", key);
  return value->word[0] - 'x';
}

void RecipeArgs::Finish(const std::string& what) const {
  for (const auto& [key, value] : values_)
    if (!value.used) place_.Fail("'{}' has no argument '{}'", what, key);
}

RecipeLine::RecipeLine(RecipePlace place, std::string text, RecipeScope& scope)
    : place_(std::move(place)), text_(std::move(text)), scope_(scope) {
  text_.resize(std::min(text_.find('#'), text_.size()));
}

void RecipeLine::SkipSpace() {
  while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
}

bool RecipeLine::AtEnd() {
  SkipSpace();
  return at_ == text_.size();
}

char RecipeLine::Peek() {
  SkipSpace();
  return at_ < text_.size() ? text_[at_] : '\0';
}

bool RecipeLine::Accept(char c) {
  if (Peek() != c) return false;
  ++at_;
  return true;
}

void RecipeLine::Expect(char c) {
  if (!Accept(c))
    place_.Fail("expected '{}', found {}", c,
                AtEnd() ? "the end of the line" : fmt::format("'{}'", text_.substr(at_, 12)));
}

void RecipeLine::ExpectEnd() {
  if (!AtEnd()) place_.Fail("expected the end of the line, found '{}'", text_.substr(at_, 12));
}

std::string RecipeLine::Word(const char* what) {
  if (!IsWordStart(Peek()))
    place_.Fail("expected {}, found {}", what,
                AtEnd() ? "the end of the line" : fmt::format("'{}'", text_.substr(at_, 12)));
  const std::size_t start = at_;
  while (at_ < text_.size() && IsWordPart(text_[at_])) ++at_;
  return text_.substr(start, at_ - start);
}

std::string RecipeLine::Rest() {
  SkipSpace();
  std::string rest = text_.substr(std::exchange(at_, text_.size()));
  rest.resize(rest.find_last_not_of(" \t\r") + 1);
  return rest;
}

RecipeArgs RecipeLine::Arguments() {
  RecipeArgs args(place_);
  while (!AtEnd()) {
    const std::string key = Word("an argument");
    Expect('=');
    RecipeArgs::Value value;
    if (key == "mirror" || key == "around") {
      value.word = Word("x, y or z");
    } else {
      value.tuples.push_back(TupleOrNumber());
      while (Peek() == '(') value.tuples.push_back(TupleOrNumber());
    }
    if (!args.values_.emplace(key, std::move(value)).second)
      place_.Fail("argument '{}' is given twice", key);
  }
  return args;
}

// "(a, b, ...)" or an expression; a parenthesis without a comma is plain grouping.
RecipeArgs::Tuple RecipeLine::TupleOrNumber() {
  if (Peek() != '(') return {Expression()};
  const std::size_t start = at_;
  const Rng before = scope_.rng;
  Accept('(');
  RecipeArgs::Tuple tuple = {Expression()};
  while (Accept(',')) tuple.push_back(Expression());
  Expect(')');
  if (tuple.size() > 1) return tuple;
  at_ = start;  // read again as an expression, with the same draws
  scope_.rng = before;
  return {Expression()};
}

double RecipeLine::Expression() {
  double value = Term();
  for (;;) {
    if (Accept('+'))
      value += Term();
    else if (Accept('-'))
      value -= Term();
    else
      return value;
  }
}

double RecipeLine::Term() {
  double value = Factor();
  for (;;) {
    if (Accept('*'))
      value *= Factor();
    else if (Accept('/'))
      value /= Factor();
    else
      return value;
  }
}

double RecipeLine::Factor() {
  if (Accept('-')) return -Factor();
  if (Accept('(')) {
    const double value = Expression();
    Expect(')');
    return value;
  }
  if (!IsWordStart(Peek())) return Literal();
  const std::string name = Word("a number");
  if (Peek() == '(') return Function(name);
  const auto found = scope_.names.find(name);
  if (found == scope_.names.end())
    place_.Fail("'{}' is not defined; expected 'let {} = ...' above", name, name);
  return found->second;
}

double RecipeLine::Literal() {
  double value = 0;
  const char* first = text_.data() + at_;
  const auto [end, error] = std::from_chars(first, text_.data() + text_.size(), value);
  if (error != std::errc() || !std::isfinite(value))
    place_.Fail("expected a number, found {}",
                AtEnd() ? "the end of the line" : fmt::format("'{}'", text_.substr(at_, 12)));
  at_ += static_cast<std::size_t>(end - first);
  return value;
}

double RecipeLine::Function(const std::string& name) {
  Expect('(');
  std::vector<double> a = {Expression()};
  while (Accept(',')) a.push_back(Expression());
  Expect(')');
  const auto takes = [&](std::size_t count) {
    if (a.size() != count)
      place_.Fail("{}(): expected {} number(s), found {}", name, count, a.size());
  };
  if (name == "each") {
    takes(scope_.variants);
    return a[scope_.variant];
  }
  if (name == "pick") return a[scope_.rng.Index(a.size())];
  if (name == "min") return *std::min_element(a.begin(), a.end());
  if (name == "max") return *std::max_element(a.begin(), a.end());
  if (name == "uniform") {
    takes(2);
    return scope_.rng.Uniform(a[0], a[1]);
  }
  takes(1);
  const double radians = a[0] * std::numbers::pi / 180;
  if (name == "sin") return std::sin(radians);
  if (name == "cos") return std::cos(radians);
  if (name == "abs") return std::abs(a[0]);
  if (name == "sqrt" && a[0] >= 0) return std::sqrt(a[0]);
  place_.Fail("expected one of uniform, pick, each, min, max, sin, cos, abs, sqrt; found '{}({})'",
              name, a[0]);
}

}  // namespace dexremoe
