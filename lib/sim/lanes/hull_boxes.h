// Rounded boxes inside one convex hull: candidates for its cover.
#pragma once

#include <vector>

#include "sim/lanes/hull_cover.h"

namespace dexremoe {

// Boxes in a few orientations, of a few roundings, grown in several orders from many inner points
// until every side is stopped by a face plane of the hull, `overhang` outside of it. Below three
// extents, boxes grow along that many axes only. Never empty.
std::vector<RoundedBox> BoxesInside(const TriMesh& hull, const CoverOptions& options);

}  // namespace dexremoe
