// Objects as recipes: a small text language for constructive modelling with signed distances.
//
// A recipe is data/recipes/CATEGORY/NAME.recipe. x points forward, y left, z up; units are free,
// the mesh is scaled afterwards. One statement per line, # starts a comment:
//
//   class NAME                      finer than the category; first line, optional
//   variants NAME NAME ...          objects made of this recipe, instead of one with the file's
//                                   name; next line, optional. Each draws numbers of its own, and
//                                   its name stands for 1, the names of the others for 0
//   include FILE                    the statements of a file beside this one, in place
//   let NAME = EXPRESSION           numbers, + - * / ( ), uniform(a,b), pick(a,b,...), min, max,
//                                   sin, cos (degrees), abs, sqrt; the seed decides what is drawn;
//                                   each(a,b,...) takes the number of the variant's place
//   triangles N                     about how many the mesh has (default 14000)
//   resolution N                    or the voxels along the longest side
//   OP SHAPE key=value ...          OP is add, cut or keep (intersect)
//   OP group key=value ... / end    the statements between form one shape
//
// Shapes (tuples are written (a,b,c), lists of tuples one after the other):
//
//   sphere r=          ellipsoid r=(x,y,z)     box size=(x,y,z) [round=]     torus r=(ring,tube),
//   axis z capsule from= to= r=a or (a,b)             cylinder from= to= r=a or (a,b) [round=]
//   plane normal=      everything behind the plane through the origin
//   tube points=(x,y,z,r)... [straight=1]      a smooth curve through the points
//   loft stations=(x,z,width,height)... or (x,z,width,up,down[,power]) [round=]
//                      half sizes of superellipse sections along x around (y=0, z)
//   wing root=(x,y,z) tip=(x,y,z) chord=(a,b) thick=(a,b) [power=]   root and tip: leading edge
//   extrude outline=(x,z)... width= [round=]   a polygon, symmetric in y
//
// Every shape and group also takes
//
//   when=     0 leaves it out
//   smooth=   blends the joint over this width        mirror=x|y|z  adds the mirror image
//   at=(x,y,z), turn=(x,y,z) degrees, about fixed axes in this order, scale=s or (x,y,z)
//   repeat=N step=(x,y,z)                             N copies in a row
//   repeat=N around=x|y|z                             or evenly about an axis through the origin
//   taper=(x0,x1,s0,s1)  scales y and z from s0 at x0 to s1 at x1
//   bend=D               turns sections upward by D degrees per unit of x
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/recipe_shapes.h"

namespace dexremoe {

struct Recipe {
  Field field;
  int resolution = 0;  // 0: what gives about so many triangles
  int triangles = 14000;
};

// `seed` decides the random parameters, `variant` is one of the recipe's (empty: the first). Throws
// Error ("file:line: ...") for anything wrong.
Recipe ParseRecipe(const std::string& file, const std::string& text, std::uint64_t seed,
                   const std::string& variant = "");

// One closed manifold shell, its longest side `length` (m), centred in its bounding box.
// Crumbs of less than a thousandth of its volume are left out. Throws Error naming `label` when the
// recipe gives nothing or several separate shells.
TriMesh MeshOfRecipe(const Recipe& recipe, double length, const std::string& label);

// What stands at the top of a recipe.
struct RecipeHead {
  std::string object_class;           // empty when not said
  std::vector<std::string> variants;  // empty when not said
  int lines = 0;                      // of the text, read so far
};
RecipeHead ReadRecipeHead(const std::string& file, const std::string& text);

// An object that a recipe describes; `name` is the variant's, or the file's when it has none.
struct RecipeObject {
  std::string path, category, name, object_class;
};
// The objects of all FOLDER/CATEGORY/NAME.recipe, by category and name. Throws Error when there is
// none, and for a name that a category has twice.
std::vector<RecipeObject> FindRecipes(const std::string& folder);
// Reads and parses one. What it draws depends on `seed`, its category and its name only.
Recipe LoadRecipe(const RecipeObject& object, std::uint64_t seed);

}  // namespace dexremoe
