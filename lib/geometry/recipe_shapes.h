// The shapes that recipes are made of, as signed distances (approximate where noted: right in sign
// and at the surface, never much too large outside).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "geometry/recipe_text.h"

namespace dexremoe {

// Negative inside.
using Field = std::function<double(const Eigen::Vector3d&)>;

// Reads the arguments of shape `name` and returns its field. Throws Error naming file and line for
// an unknown shape or wrong arguments. Shapes and their arguments are listed in recipes.h.
Field MakeShape(const std::string& name, RecipeArgs& args);

// Polynomial smooth minimum (Quilez): equals min(a, b) where they differ by more than k.
double SmoothMin(double a, double b, double k);

// First-order distance to an ellipse |u/a|^n + |v/b|^n = 1.
double SuperellipseDistance(double u, double v, double a, double b, double n);

// Swept shapes (recipe_sweeps.cpp).
Field MakeTube(RecipeArgs& args);
Field MakeLoft(RecipeArgs& args);
Field MakeWing(RecipeArgs& args);
Field MakeExtrusion(RecipeArgs& args);

}  // namespace dexremoe
