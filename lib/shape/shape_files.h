// shape_net.h5 and shape.h5.
#pragma once

#include <string>

#include "io/h5.h"
#include "shape/shape_net.h"
#include "shape/training.h"

namespace dexremoe {

inline constexpr H5Format kShapeNetFormat = {"dexremoe.shape_net", 1};
inline constexpr H5Format kShapeFormat = {"dexremoe.shape", 1};

// Sizes, weights by name, categories, the learning curve and the trial on held-out objects.
void WriteShapeNet(const std::string& path, const ShapeNet& net, const ShapeTraining& training,
                   const Provenance& provenance);
// Throws Error naming file, dataset, expected and found.
ShapeNet ReadShapeNet(const std::string& path);

void WriteShape(const std::string& path, const ShapeDescriptor& descriptor,
                const Provenance& provenance);
ShapeDescriptor ReadShape(const std::string& path);

// The learning curve as CSV.
std::string CurveCsv(const ShapeCurve& curve);

}  // namespace dexremoe
