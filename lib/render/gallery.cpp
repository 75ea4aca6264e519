#include "render/gallery.h"

#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

constexpr int kPerPage = 25;

}  // namespace

void SheetOptions::Register(Options& options) {
  options.Add("columns", &columns, "cells side by side in a sheet; 0 takes 6, of parts 3")
      .Range(0, 64);
  options.Add("up", &up,
              "axis of the objects that stands upright: x, y, z, -x, -y, -z, or auto (from the "
              "meshes' manifest)");
  options.Add("explode", &explode, "how far parts are moved apart, relative").Range(0, 5);
}

std::vector<ObjectEntry> ByCategory(std::vector<ObjectEntry> entries) {
  std::stable_sort(entries.begin(), entries.end(), [](const ObjectEntry& a, const ObjectEntry& b) {
    return a.category < b.category;
  });
  return entries;
}

Image DrawSheet(Renderer& renderer, const Fonts& fonts, SheetKind kind,
                const std::vector<ObjectEntry>& entries, const SheetOptions& options,
                const SheetProgress& progress) {
  int done = 0;
  const ObjectSource source = [&](int i) {
    progress(done++, entries[i].name);
    return ReadSheetObject(entries[i], options.up, kind);
  };
  if (kind == SheetKind::kDataset)
    return DatasetSheet(renderer, fonts, entries, source, options.width > 0 ? options.width : 1800);
  const bool parts = kind == SheetKind::kParts;
  const int columns = options.columns > 0 ? options.columns : parts ? 3 : 6;
  const int width = options.width > 0 ? options.width : columns * (parts ? 500 : 240);
  const int count = static_cast<int>(entries.size());
  if (parts) return PartsSheet(renderer, fonts, count, source, options.explode, columns, width);
  return ObjectSheet(renderer, fonts, entries, source, columns, width);
}

std::vector<GalleryPage> PagesOf(const std::vector<ObjectEntry>& entries, int per_page) {
  std::vector<GalleryPage> pages;
  const int count = static_cast<int>(entries.size());
  for (int first = 0; first < count;) {
    const std::string& category = entries[first].category;
    int end = first;
    while (end < count && entries[end].category == category) ++end;
    for (int page = 1; first < end; first += per_page, ++page)
      pages.push_back({page == 1 ? category : fmt::format("{}_{}", category, page), first,
                       std::min(per_page, end - first)});
    first = end;
  }
  return pages;
}

void DrawGallery(Renderer& renderer, const Fonts& fonts, const std::vector<ObjectEntry>& entries,
                 const SheetOptions& options, const std::string& folder,
                 const SheetProgress& progress) {
  std::filesystem::create_directories(folder);
  std::string index;
  int before = 0;
  for (const std::string name : {"objects", "parts", "clouds"})
    for (const GalleryPage& page : PagesOf(entries, kPerPage)) {
      const std::vector<ObjectEntry> chosen(entries.begin() + page.first,
                                            entries.begin() + page.first + page.count);
      SheetOptions sheet = options;
      if (sheet.columns == 0 && name != "parts") sheet.columns = 5;
      const std::string file = fmt::format("{}_{}.png", name, page.name);
      const SheetProgress show = [&](int done, const std::string& object) {
        progress(before + done, object);
      };
      WritePng(folder + "/" + file,
               DrawSheet(renderer, fonts, SheetKindNamed(name), chosen, sheet, show));
      index += file + "\n";
      before += page.count;
    }
  WriteFile(folder + "/index.txt", index);
}

}  // namespace dexremoe
