#include "render/object_sheet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "render/episode_view.h"

namespace dexremoe {
namespace {

constexpr double kPartCrease = 0.3;  // rad; hulls have flat faces

// Several meshes standing on a floor, seen from the front, the right and above.
Image StandingPicture(Renderer& renderer, std::vector<Item> items,
                      const std::vector<TriMesh>& meshes, const Eigen::Vector3d& up, int width,
                      int height) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ());
  Box3 box;
  for (std::size_t i = 0; i < items.size(); ++i) {
    items[i].X_WM = Pose{turn, Eigen::Vector3d::Zero()} * items[i].X_WM;
    for (const Eigen::Vector3d& vertex : meshes[i].vertices) box.Extend(items[i].X_WM * vertex);
  }
  Sphere sphere{box.Center(), 0};
  for (std::size_t i = 0; i < items.size(); ++i)
    for (const Eigen::Vector3d& vertex : meshes[i].vertices)
      sphere.radius = std::max(sphere.radius, (items[i].X_WM * vertex - sphere.center).norm());
  Scene scene;
  scene.items = std::move(items);
  scene.top = scene.bottom = Eigen::Vector3f::Ones();
  scene.floor = Floor{{sphere.center.x(), sphere.center.y(), box.min.z()},
                      Eigen::Vector3d::UnitZ(),
                      1.5 * sphere.radius};
  scene.light = {-0.35, 0.95, 0.55};
  const Camera camera = FrameSphere(sphere, {0.9, -0.9, 0.55}, Eigen::Vector3d::UnitZ(), 0.42,
                                    double(width) / height, 0.97);
  return renderer.Draw(scene, camera, width, height);
}

// Soft enough for shading to show; the same whichever other categories are on the sheet.
Eigen::Vector3f ColorOf(const std::string& category) {
  return 0.8f * palette::Distinct(CategoryIndex(category)).array() + 0.16f;
}

Image MeshPicture(Renderer& renderer, const SheetObject& object, const Eigen::Vector3f& color,
                  int width, int height) {
  renderer.ClearMeshes();
  Item item;
  item.mesh = renderer.AddMesh(object.mesh, CreaseOf(object.category));
  item.material = palette::kObject;
  item.material.color = color;
  return StandingPicture(renderer, {item}, {object.mesh}, object.up, width, height);
}

Image PartsPicture(Renderer& renderer, const SheetObject& object, double explode, int width,
                   int height) {
  renderer.ClearMeshes();
  Box3 box;
  for (const TriMesh& part : object.parts)
    for (const Eigen::Vector3d& vertex : part.vertices) box.Extend(vertex);
  const Eigen::Vector3d middle = box.Center();
  std::vector<Item> items;
  for (std::size_t p = 0; p < object.parts.size(); ++p) {
    Item item;
    item.mesh = renderer.AddMesh(object.parts[p], kPartCrease);
    item.X_WM.p = explode * (BoundsOf(object.parts[p]).Center() - middle);
    item.material = {palette::Wheel(int(p)), 0.25f, 1};
    items.push_back(item);
  }
  return StandingPicture(renderer, items, object.parts, object.up, width, height);
}

// A category's cells: `columns` wide, at most, from cell (column, line) on.
struct Block {
  std::string category;
  int first = 0, count = 0;
  int column = 0, columns = 0;
  int row = 0;  // rows of blocks
  int lines() const { return (count + columns - 1) / columns; }
};

// Blocks from left to right, a new row of blocks when the next does not fit.
std::vector<Block> LayOut(const std::vector<ObjectEntry>& entries, int columns) {
  std::vector<Block> blocks;
  int used = 0, row = 0;
  for (int i = 0; i < int(entries.size());) {
    Block block{entries[i].category, i, 0, 0, 0, 0};
    while (i < int(entries.size()) && entries[i].category == block.category) ++i;
    block.count = i - block.first;
    block.columns = std::min(block.count, columns);
    if (used + block.columns > columns) {
      ++row;
      used = 0;
    }
    block.column = used;
    block.row = row;
    used += block.columns;
    blocks.push_back(block);
  }
  return blocks;
}

}  // namespace

Image ObjectSheet(Renderer& renderer, const Fonts& fonts, const std::vector<ObjectEntry>& entries,
                  const ObjectSource& source, int columns, int width) {
  const std::vector<Block> blocks = LayOut(entries, columns);
  const int cell = width / columns, picture = cell * 4 / 5;
  const double size = std::clamp(cell * 0.075, 8.0, 18.0);
  const int heading = int(2.6 * size), caption = int(1.9 * size);
  std::vector<int> row_top{0};  // of each row of blocks
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const int bottom = row_top[blocks[b].row] + heading + blocks[b].lines() * (picture + caption);
    row_top.resize(blocks[b].row + 2, 0);
    row_top.back() = std::max(row_top.back(), bottom);
  }
  Image sheet(cell * columns, row_top.back() + int(size), 255, 255, 255);
  Canvas canvas(sheet, fonts);
  for (const Block& block : blocks) {
    const int left = block.column * cell, top = row_top[block.row];
    const Eigen::Vector3f color = ColorOf(block.category);
    canvas.Box(left + 0.04 * cell, top + heading - 0.45 * size, (block.columns - 0.08) * cell,
               std::max(1.5, 0.14 * size), color, 0.07 * size);
    canvas.Text(left + 0.05 * cell, top + heading - 0.95 * size,
                fmt::format("{} ({})", block.category, block.count),
                {1.15 * size, ink::kText, Align::kLeft, true});
    for (int i = 0; i < block.count; ++i) {
      const SheetObject object = source(block.first + i);
      const int x = left + i % block.columns * cell;
      const int y = top + heading + i / block.columns * (picture + caption);
      canvas.Paste(x, y, MeshPicture(renderer, object, color, cell, picture));
      const TextStyle style{size, ink::kFaint, Align::kCenter};
      canvas.Text(x + cell / 2.0, y + picture + size,
                  fonts.Fit(SpokenName(object.name), style, 0.92 * cell), style);
    }
  }
  return sheet;
}

Image CategoryPicture(Renderer& renderer, const SheetObject& object, const std::string& category,
                      int width, int height) {
  return MeshPicture(renderer, object, ColorOf(category), width, height);
}

Image ObjectPicture(Renderer& renderer, const SheetObject& object, double explode, int width,
                    int height) {
  return object.parts.empty() ? MeshPicture(renderer, object, palette::kObject.color, width, height)
                              : PartsPicture(renderer, object, explode, width, height);
}

Image PartsSheet(Renderer& renderer, const Fonts& fonts, int count, const ObjectSource& source,
                 double explode, int columns, int width) {
  DEX_CHECK_GT(count, 0);
  columns = std::min(columns, count);
  const int cell = width / columns, half = cell / 2, picture = half * 4 / 5;
  const double size = std::clamp(half * 0.065, 8.0, 18.0);
  const int caption = int(3.8 * size), lines = (count + columns - 1) / columns;
  Image sheet(cell * columns, lines * (picture + caption), 255, 255, 255);
  Canvas canvas(sheet, fonts);
  for (int i = 0; i < count; ++i) {
    const SheetObject object = source(i);
    const int x = i % columns * cell, y = i / columns * (picture + caption);
    canvas.Paste(x, y, MeshPicture(renderer, object, palette::kObject.color, half, picture));
    canvas.Paste(x + half, y, PartsPicture(renderer, object, explode, half, picture));
    TextStyle style{1.05 * size, ink::kText, Align::kCenter, true};
    canvas.Text(x + half, y + picture + size, fonts.Fit(SpokenName(object.name), style, 0.9 * cell),
                style);
    style = {0.95 * size, ink::kFaint, Align::kCenter};
    canvas.Text(x + half, y + picture + 2.4 * size, fonts.Fit(object.detail, style, 0.9 * cell),
                style);
  }
  return sheet;
}

}  // namespace dexremoe
