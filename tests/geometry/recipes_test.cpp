#include "geometry/recipes.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "io/atomic_file.h"
#include "shapes.h"

namespace dexremoe {
namespace {

double At(const std::string& text, const Eigen::Vector3d& p, std::uint64_t seed = 1) {
  return ParseRecipe("test.recipe", text, seed).field(p);
}

std::string ErrorOf(const std::string& text) {
  try {
    ParseRecipe("test.recipe", text, 1);
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "no error for: " << text;
  return {};
}

TEST(Recipe, ShapesHaveTheirDistances) {
  EXPECT_NEAR(At("add sphere r=0.5 at=(1,0,0)", {3, 0, 0}), 1.5, 1e-12);
  EXPECT_NEAR(At("add box size=(2,4,6)", {2, 0, 0}), 1, 1e-12);
  EXPECT_NEAR(At("add box size=(2,4,6) round=0.2", {0, 0, 0}), -1, 1e-12);
  EXPECT_NEAR(At("add capsule from=(0,0,0) to=(2,0,0) r=0.3", {1, 1, 0}), 0.7, 1e-12);
  EXPECT_NEAR(At("add cylinder from=(0,0,-1) to=(0,0,1) r=0.5", {0, 2, 0}), 1.5, 1e-12);
  EXPECT_NEAR(At("add cylinder from=(0,0,-1) to=(0,0,1) r=0.5", {0, 0, 3}), 2, 1e-12);
  EXPECT_NEAR(At("add torus r=(1,0.2)", {1.5, 0, 0}), 0.3, 1e-12);
  EXPECT_NEAR(At("add ellipsoid r=(1,2,3)", {0, 2, 0}), 0, 1e-12);
  EXPECT_NEAR(At("add plane normal=(0,0,2) at=(0,0,1)", {5, 5, 4}), 3, 1e-12);
  EXPECT_NEAR(At("add tube points=(0,0,0,0.1)(1,0,0,0.1) straight=1", {0.5, 0, 1}), 0.9, 1e-12);
  EXPECT_NEAR(At("add extrude outline=(-1,-1)(1,-1)(1,1)(-1,1) width=2", {0, 3, 0}), 2, 1e-12);
  EXPECT_NEAR(At("add loft stations=(-1,0,0.5,0.5)(1,0,0.5,0.5)", {0, 0.5, 0}), 0, 1e-9);
  EXPECT_NEAR(At("add wing root=(0.5,0,0) tip=(0.5,2,0) chord=1 thick=0.2", {0, 1, 0.1}), 0, 1e-9);
}

TEST(Recipe, RoundConeEqualsTheUnionOfItsBalls) {
  const std::string text = "add capsule from=(0,0,0) to=(2,0,0) r=(0.5,0.2)";
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(-1, 0.3, 0.2), Eigen::Vector3d(2.5, 0, 0.7)}) {
    double least = INFINITY;
    for (int i = 0; i <= 20000; ++i) {
      const double t = i / 20000.0;
      least = std::min(least, (p - Eigen::Vector3d(2 * t, 0, 0)).norm() - (0.5 - 0.3 * t));
    }
    EXPECT_NEAR(At(text, p), least, 1e-6);
  }
}

TEST(Recipe, OperationsAndPlacements) {
  const std::string box = "add box size=2\n";
  EXPECT_GT(At(box + "cut sphere r=0.5", {0, 0, 0}), 0);
  EXPECT_LT(At(box + "keep sphere r=0.5", {0, 0, 0}), 0);
  EXPECT_GT(At(box + "keep sphere r=0.5", {0.8, 0, 0}), 0);
  EXPECT_LT(At("add sphere r=1 at=(0,2,0) mirror=y", {0, -2, 0}), 0);
  EXPECT_LT(At("add sphere r=0.4 repeat=3 step=(1,0,0)", {2, 0, 0}), 0);
  EXPECT_GT(At("add sphere r=0.4 repeat=3 step=(1,0,0)", {3, 0, 0}), 0);
  EXPECT_LT(At("add box size=(4,1,1) turn=(0,0,90)", {0, 1.8, 0}), 0);
  EXPECT_LT(At("add box size=(4,1,1) turn=(0,-90,0)", {0, 0, 1.8}), 0);
  EXPECT_LT(At("add sphere r=1 scale=(3,1,1)", {2.8, 0, 0}), 0);
  EXPECT_GT(At("add box size=(4,2,2) taper=(-2,2,1,0.2)", {1.9, 0.8, 0}), 0);
  EXPECT_LT(At("add box size=(4,1,1) bend=30", {1.6, 0, 1.2}), 0);  // its ends rise
  EXPECT_GT(At("add box size=(4,1,1)", {1.6, 0, 1.2}), 0);
  EXPECT_LT(At("add sphere r=1\nadd sphere r=1 at=(2.1,0,0) smooth=0.5", {1.05, 0, 0}), 0);
  EXPECT_LT(At("add group at=(5,0,0)\n add box size=2\n cut sphere r=0.5\nend", {5.8, 0, 0}), 0);
  EXPECT_GT(At("add group at=(5,0,0)\n add box size=2\n cut sphere r=0.5\nend", {5, 0, 0}), 0);
}

TEST(Recipe, CopiesStandInARowOrAroundAnAxis) {
  const std::string row = "add sphere r=0.4 repeat=3 step=(1,0,0) mirror=y at=(0,1,0)";
  EXPECT_LT(At(row, {2, -1, 0}), 0);
  const std::string ring = "add sphere r=0.1 at=(1,0,0) repeat=4 around=z";
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0),
                                   Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, -1, 0)})
    EXPECT_NEAR(At(ring, p), -0.1, 1e-12);
  EXPECT_GT(At(ring, {0, 0, 1}), 0.5);
}

TEST(Recipe, VariantsDifferInWhatTheirNamesSay) {
  const std::string text =
      "class ball\nvariants small large\nadd sphere r=each(1,2)\n"
      "add sphere r=0.5 at=(5,0,0) when=large\ncut group when=small\n add sphere r=0.1\nend";
  const RecipeHead head = ReadRecipeHead("v", text);
  EXPECT_EQ(head.object_class, "ball");
  EXPECT_EQ(head.variants, (std::vector<std::string>{"small", "large"}));
  const auto at = [&](const char* variant, const Eigen::Vector3d& p) {
    return ParseRecipe("v", text, 1, variant).field(p);
  };
  EXPECT_NEAR(at("small", {3, 0, 0}), 2, 1e-12);
  EXPECT_NEAR(at("large", {3, 0, 0}), 1, 1e-12);
  EXPECT_GT(at("small", {5, 0, 0}), 0);
  EXPECT_LT(at("large", {5, 0, 0}), 0);
  EXPECT_GT(at("small", {0, 0, 0}), 0);
  EXPECT_LT(at("large", {0, 0, 0}), 0);
}

TEST(Recipe, IncludedStatementsStandInPlace) {
  const std::string folder = ::testing::TempDir() + "include_test/";
  WriteFile(folder + "ball.part", "add sphere r=radius\n");
  WriteFile(folder + "open.part", "add group\nadd sphere r=1\n");
  WriteFile(folder + "endless.part", "include endless.part\n");
  const auto at = [&](const std::string& text, const Eigen::Vector3d& p) {
    return ParseRecipe(folder + "r.recipe", text, 1).field(p);
  };
  const std::string text = "let radius = 0.5\nadd group at=(3,0,0)\n include ball.part\nend";
  EXPECT_NEAR(at(text, {3, 0, 0}), -0.5, 1e-12);
  for (const auto& [file, message] : std::initializer_list<std::pair<const char*, const char*>>{
           {"none.part", "r.recipe:1: include: expected a file"},
           {"ball.part", "ball.part:1: 'radius' is not defined"},
           {"open.part", "expected as many 'group' as 'end'"},
           {"endless.part", "expected at most 8 files within each other"}}) {
    try {
      at(fmt::format("include {}", file), {0, 0, 0});
      ADD_FAILURE() << file;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  }
}

TEST(Recipe, ExpressionsAndDraws) {
  EXPECT_NEAR(At("let a = 2*(1+0.5) - 4/2\nadd sphere r=a", {0, 0, 0}), -1, 1e-12);
  EXPECT_NEAR(At("add sphere r=-(-1)*cos(60)  # half", {0, 0, 0}), -0.5, 1e-12);
  EXPECT_NEAR(At("add sphere r=(1+1)*max(0.5, 0.25, 0.1)", {0, 0, 0}), -1, 1e-12);
  const std::string drawn = "let r = uniform(0.5, 1)\nadd sphere r=r";
  EXPECT_EQ(At(drawn, {0, 0, 0}, 3), At(drawn, {0, 0, 0}, 3));
  EXPECT_NE(At(drawn, {0, 0, 0}, 3), At(drawn, {0, 0, 0}, 4));
  EXPECT_GE(-At(drawn, {0, 0, 0}, 3), 0.5);
  EXPECT_LE(-At(drawn, {0, 0, 0}, 3), 1);
}

TEST(Recipe, ErrorsNameFileLineAndWhat) {
  struct Case {
    const char* text;
    const char* message;
  };
  for (const Case& c : std::initializer_list<Case>{
           {"add sphere r=1\nadd spere r=1", "test.recipe:2: expected a shape (box"},
           {"add sphere radius=1", "test.recipe:1: expected 'r=', found none"},
           {"add sphere r=1 color=3", "test.recipe:1: 'sphere' has no argument 'color'"},
           {"add sphere r=0", "test.recipe:1: r: expected more than 0, found 0"},
           {"add sphere r=q", "test.recipe:1: 'q' is not defined"},
           {"add sphere r=1 r=2", "test.recipe:1: argument 'r' is given twice"},
           {"add sphere r=1 at=(1,2)", "test.recipe:1: at: expected 3 number(s), found 2"},
           {"add sphere r=1 mirror=w", "test.recipe:1: mirror: expected x, y or z"},
           {"add sphere r=(1", "test.recipe:1: expected ')', found the end of the line"},
           {"grow sphere r=1", "test.recipe:1: expected let, include, triangles, resolution,"},
           {"add sphere r=each(1,2)", "test.recipe:1: each(): expected 1 number(s), found 2"},
           {"variants\nadd sphere r=1", "test.recipe:1: variants: expected names, found none"},
           {"add sphere r=1\nclass a", "test.recipe:2: expected let,"},
           {"add sphere r=1 repeat=3", "test.recipe:1: expected 'step='"},
           {"triangles 5", "test.recipe:1: triangles: expected 500 to 100000, found 5"},
           {"cut sphere r=1", "test.recipe:1: expected 'add' first"},
           {"add group\nadd sphere r=1", "test.recipe:1: group: expected 'end'"},
           {"\n\nend", "test.recipe:3: expected a statement, found 'end' without a group"},
           {"let 3 = 4", "test.recipe:1: expected a name, found '3 = 4'"},
           {"let a = 1/0", "test.recipe:1: a: expected a finite number"},
           {"resolution 5", "test.recipe:1: resolution: expected 16 to 256, found 5"},
           {"# nothing", "test.recipe:1: expected at least one shape"},
           {"add loft stations=(1,0,1,1)(0,0,1,1)", "expected rising x"},
           {"let a = root(4)", "test.recipe:1: expected one of uniform"}}) {
    const std::string message = ErrorOf(c.text);
    EXPECT_NE(message.find(c.message), std::string::npos) << message;
  }
}

TEST(MeshOfRecipe, GivesAClosedShellOfTheRightVolume) {
  const Recipe recipe = ParseRecipe("ball", "resolution 48\nadd sphere r=0.7 at=(2,1,0)", 1);
  const TriMesh mesh = MeshOfRecipe(recipe, 0.1, "ball");
  EXPECT_TRUE(TopologyOf(mesh).ClosedManifold());
  EXPECT_NEAR(BoundsOf(mesh).Size().maxCoeff(), 0.1, 1e-12);
  EXPECT_NEAR(MassPropertiesOf(mesh).volume, std::numbers::pi / 6 * 1e-3, 0.005e-3);
}

TEST(MeshOfRecipe, HasAboutAsManyTrianglesAsAsked) {
  for (const char* shape : {"add sphere r=0.7", "add box size=(2,0.2,0.1) round=0.02"})
    for (const int count : {3000, 10000}) {
      const std::string text = fmt::format("triangles {}\n{}", count, shape);
      const auto found = MeshOfRecipe(ParseRecipe("r", text, 1), 0.1, "r").triangles.size();
      EXPECT_NEAR(static_cast<double>(found) / count, 1, 0.2) << text;
    }
}

TEST(MeshOfRecipe, RefusesNothingAndSeparatePieces) {
  const auto error = [](const std::string& text) {
    try {
      MeshOfRecipe(ParseRecipe("r", text, 1), 0.1, "r");
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(error("add sphere r=0.1\nadd sphere r=0.2 at=(1,0,0)").find("found 2"),
            std::string::npos);
  EXPECT_NE(error("add sphere r=1\ncut sphere r=0.5").find("bubble"), std::string::npos);
  EXPECT_NE(error("add sphere r=0.5\ncut sphere r=1"), "");
  EXPECT_EQ(error("add sphere r=1\nadd sphere r=0.06 at=(1.2,0,0)"), "");  // a crumb
}

TEST(MeshOfRecipe, IsDeterministic) {
  const Recipe recipe =
      ParseRecipe("r", "resolution 32\nadd box size=(2,1,uniform(0.5,1)) round=0.2", 5);
  EXPECT_EQ(MeshOfRecipe(recipe, 0.1, "r").vertices, MeshOfRecipe(recipe, 0.1, "r").vertices);
}

}  // namespace
}  // namespace dexremoe
