// How training objects are shared out among experts.
#include "task/object_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "base/error.h"

namespace dexremoe {
namespace {

ObjectEntry Entry(const std::string& name, const std::string& category, const std::string& cls,
                  const std::string& split = "train") {
  return {name, category, split, "", "", "", cls};
}

// Five airplanes of three classes, four shoes of one, a train; one bus out of distribution.
std::vector<ObjectEntry> Entries() {
  return {Entry("a1", "airplane", "jet"),  Entry("s1", "shoe", "boot"),
          Entry("a2", "airplane", "prop"), Entry("s2", "shoe", "boot"),
          Entry("a3", "airplane", "jet"),  Entry("bus", "vehicle", "bus", "ood"),
          Entry("a4", "airplane", "prop"), Entry("s3", "shoe", "boot"),
          Entry("a5", "airplane", "jet"),  Entry("s4", "shoe", "boot"),
          Entry("t1", "train", "steam")};
}

std::vector<std::vector<std::string>> Names(int groups) {
  std::vector<std::vector<std::string>> names;
  for (const auto& group : GroupObjects(Entries(), groups)) {
    names.emplace_back();
    for (const ObjectEntry& entry : group) names.back().push_back(entry.name);
  }
  return names;
}

using Parts = std::vector<std::vector<std::string>>;

TEST(ObjectGroups, OneGroupHasAllTrainingObjects) { EXPECT_EQ(Names(1).at(0).size(), 10u); }

TEST(ObjectGroups, AsManyAsCategoriesAreTheCategories) {
  EXPECT_EQ(Names(3), (Parts{{"a1", "a2", "a3", "a4", "a5"}, {"s1", "s2", "s3", "s4"}, {"t1"}}));
}

TEST(ObjectGroups, TheLargestCategoryIsSplitBetweenItsClasses) {
  EXPECT_EQ(Names(4), (Parts{{"a1", "a3", "a5"}, {"a2", "a4"}, {"s1", "s2", "s3", "s4"}, {"t1"}}));
}

TEST(ObjectGroups, OneClassIsCutInTheMiddle) {
  EXPECT_EQ(Names(5),
            (Parts{{"a1", "a3", "a5"}, {"a2", "a4"}, {"s1", "s2"}, {"s3", "s4"}, {"t1"}}));
}

TEST(ObjectGroups, EveryTrainingObjectIsInOneGroup) {
  for (const int groups : {1, 3, 4, 5, 6, 8, 10}) {
    const auto names = Names(groups);
    EXPECT_EQ(names.size(), static_cast<std::size_t>(groups));
    std::multiset<std::string> all;
    for (const auto& group : names) {
      EXPECT_FALSE(group.empty());
      all.insert(group.begin(), group.end());
    }
    EXPECT_EQ(all, (std::multiset<std::string>{"a1", "a2", "a3", "a4", "a5", "s1", "s2", "s3", "s4",
                                               "t1"}));
  }
}

TEST(ObjectGroups, TooFewAndTooManyAreRefused) {
  const auto message = [](int groups) {
    try {
      GroupObjects(Entries(), groups);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(message(2), "groups: expected 1, or at least as many as categories (3), found 2");
  EXPECT_EQ(message(11), "groups: expected at most as many as training objects (10), found 11");
}

}  // namespace
}  // namespace dexremoe
