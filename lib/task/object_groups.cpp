#include "task/object_groups.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <tuple>

#include "base/error.h"

namespace dexremoe {
namespace {

using Group = std::vector<ObjectEntry>;

// Where to cut a group that is sorted by class: between classes if it can be, near the middle.
std::size_t CutOf(const Group& group) {
  const auto badness = [&](std::size_t cut) {
    const bool inside = group[cut - 1].object_class == group[cut].object_class;
    const auto size = static_cast<long>(group.size());
    return std::tuple(inside, std::labs(2 * static_cast<long>(cut) - size));
  };
  std::size_t best = 1;
  for (std::size_t cut = 2; cut < group.size(); ++cut)
    if (badness(cut) < badness(best)) best = cut;
  return best;
}

// The first half stays where the group stood, the second one follows it.
void HalveLargest(std::vector<Group>& groups) {
  const auto largest =
      std::max_element(groups.begin(), groups.end(),
                       [](const Group& a, const Group& b) { return a.size() < b.size(); });
  std::sort(largest->begin(), largest->end(), [](const ObjectEntry& a, const ObjectEntry& b) {
    return std::tie(a.object_class, a.name) < std::tie(b.object_class, b.name);
  });
  const auto cut = largest->begin() + static_cast<std::ptrdiff_t>(CutOf(*largest));
  Group rest(cut, largest->end());
  largest->erase(cut, largest->end());
  groups.insert(largest + 1, std::move(rest));
}

}  // namespace

std::vector<Group> GroupObjects(const std::vector<ObjectEntry>& entries, int groups) {
  std::map<std::string, Group> categories;
  std::size_t objects = 0;
  for (const ObjectEntry& entry : entries) {
    if (entry.split != "train") continue;
    categories[groups == 1 ? "" : entry.category].push_back(entry);
    ++objects;
  }
  const std::size_t wanted = static_cast<std::size_t>(groups);
  if (objects < wanted)
    Fail("groups: expected at most as many as training objects ({}), found {}", objects, groups);
  if (categories.size() > wanted)
    Fail("groups: expected 1, or at least as many as categories ({}), found {}", categories.size(),
         groups);
  std::vector<Group> parts;
  for (auto& [name, group] : categories) parts.push_back(std::move(group));
  while (parts.size() < wanted) HalveLargest(parts);
  return parts;
}

}  // namespace dexremoe
