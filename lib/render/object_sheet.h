// Overviews of objects and of their convex parts.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/canvas.h"
#include "render/renderer.h"
#include "render/sheet_object.h"

namespace dexremoe {

// Draws the i-th object of a sheet; called once each, in order, so that only one is in memory.
using ObjectSource = std::function<SheetObject(int)>;

// Objects on a floor, in blocks by category (entries of a category adjacent).
// `columns` cells side by side. Height follows.
Image ObjectSheet(Renderer& renderer, const Fonts& fonts, const std::vector<ObjectEntry>& entries,
                  const ObjectSource& source, int columns, int width);

// One object on a floor, in the colour of a category (one of kCategories).
Image CategoryPicture(Renderer& renderer, const SheetObject& object, const std::string& category,
                      int width, int height);

// The whole data set: a band for every category, its training objects left of a line, those out of
// distribution right of it. `entries` by category; source(i) draws entries[i]; height follows.
Image DatasetSheet(Renderer& renderer, const Fonts& fonts, const std::vector<ObjectEntry>& entries,
                   const ObjectSource& source, int width);

// Each object twice: as a mesh and as its convex parts, moved apart by `explode` times their
// distance from the middle. `columns` pairs side by side.
Image PartsSheet(Renderer& renderer, const Fonts& fonts, int count, const ObjectSource& source,
                 double explode, int columns, int width);

// One object alone: its mesh, or its parts moved apart where it has any.
Image ObjectPicture(Renderer& renderer, const SheetObject& object, double explode, int width,
                    int height);

}  // namespace dexremoe
