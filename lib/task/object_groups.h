// Objects shared out among experts (paper, IV-D, "Number of Expert Policies").
#pragma once

#include <vector>

#include "task/object_set.h"

namespace dexremoe {

// The training objects of `entries` in `groups` parts, for as many experts; those out of
// distribution are left out. One part is all of them. Otherwise parts are categories, in order of
// name, the largest part being halved until there are enough: between two classes where it has
// several, as near to the middle as can be.
// NOTE(paper): "a finer-grained taxonomy" is all it says of eight experts.
// Throws Error when there are more categories than groups, or fewer objects.
std::vector<std::vector<ObjectEntry>> GroupObjects(const std::vector<ObjectEntry>& entries,
                                                   int groups);

}  // namespace dexremoe
