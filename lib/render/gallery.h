// Contact sheets of many objects, page by page.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/options.h"
#include "render/object_sheet.h"

namespace dexremoe {

struct SheetOptions {
  int columns = 0;          // cells side by side; 0 takes 6, of parts 3
  int width = 0;            // pixels; 0 takes 240 a cell, of parts 500, of a dataset 1800 in all
  double explode = 0.25;    // how far parts are moved apart, relative
  std::string up = "auto";  // as UpAxis takes it
  void Register(Options& options);
};

// Called before every object with how many are done.
using SheetProgress = std::function<void(int done, const std::string& name)>;

// Sorted by category, else in the order they had.
std::vector<ObjectEntry> ByCategory(std::vector<ObjectEntry> entries);

// The entries, sorted by category, on one sheet: DatasetSheet, PartsSheet or ObjectSheet.
Image DrawSheet(Renderer& renderer, const Fonts& fonts, SheetKind kind,
                const std::vector<ObjectEntry>& entries, const SheetOptions& options,
                const SheetProgress& progress);

// Entries first .. first + count - 1, all of one category.
struct GalleryPage {
  std::string name;  // "animal", or "animal_2" where a category takes more than one page
  int first = 0, count = 0;
};
// Entries sorted by category, at most `per_page` on a page.
std::vector<GalleryPage> PagesOf(const std::vector<ObjectEntry>& entries, int per_page);

// Draws FOLDER/objects_PAGE.png, parts_PAGE.png and clouds_PAGE.png for every page of 25, and then
// FOLDER/index.txt with their names, one a line.
void DrawGallery(Renderer& renderer, const Fonts& fonts, const std::vector<ObjectEntry>& entries,
                 const SheetOptions& options, const std::string& folder,
                 const SheetProgress& progress);

}  // namespace dexremoe
