#include <algorithm>

#include "base/check.h"
#include "render/object_sheet.h"

namespace dexremoe {
namespace {

// One category: indices of its entries on either side of the line.
struct Band {
  std::string category;
  std::vector<int> train, ood;
};

std::vector<Band> Bands(const std::vector<ObjectEntry>& entries) {
  std::vector<Band> bands;
  for (int i = 0; i < int(entries.size()); ++i) {
    if (bands.empty() || bands.back().category != entries[i].category)
      bands.push_back({entries[i].category, {}, {}});
    (entries[i].split == "train" ? bands.back().train : bands.back().ood).push_back(i);
  }
  return bands;
}

int LinesOf(std::size_t count, int columns) { return int(count + columns - 1) / columns; }

// Where things stand. Two lines per category suffice where two thirds of them are for training.
struct Layout {
  int columns = 0;  // left of the line
  int rest = 0;     // right of it
  int cell = 0, picture = 0, gap = 0;
  int Lines(const Band& band) const {
    return std::max(LinesOf(band.train.size(), columns), LinesOf(band.ood.size(), rest));
  }
};

Layout LayOut(const std::vector<Band>& bands, int width) {
  std::size_t train = 1, ood = 1;
  for (const Band& band : bands) {
    train = std::max(train, band.train.size());
    ood = std::max(ood, band.ood.size());
  }
  Layout layout;
  layout.columns = LinesOf(train, 2);
  layout.rest = LinesOf(ood, 2);
  layout.cell = int(width / (layout.columns + layout.rest + 0.5));
  layout.picture = layout.cell * 5 / 6;
  layout.gap = layout.cell / 2;
  return layout;
}

}  // namespace

Image DatasetSheet(Renderer& renderer, const Fonts& fonts, const std::vector<ObjectEntry>& entries,
                   const ObjectSource& source, int width) {
  DEX_CHECK_GT(int(entries.size()), 0);
  const std::vector<Band> bands = Bands(entries);
  const Layout layout = LayOut(bands, width);
  const double size = std::clamp(layout.cell * 0.16, 8.0, 20.0);
  const int head = int(2.4 * size), space = int(1.6 * size);
  const int split = layout.columns * layout.cell + layout.gap / 2;
  int height = head;
  for (const Band& band : bands) height += space + layout.Lines(band) * layout.picture;
  Image sheet(width, height, 255, 255, 255);
  Canvas canvas(sheet, fonts);
  const TextStyle title{1.1 * size, ink::kText, Align::kCenter, true};
  canvas.Text(split / 2.0, 1.5 * size, "training", title);
  canvas.Text((split + width) / 2.0, 1.5 * size, "out of distribution", title);
  int top = head;
  for (const Band& band : bands) {
    canvas.Text(0.5 * size, top + size, band.category, {size, ink::kFaint, Align::kLeft, true});
    top += space;
    const auto paste = [&](const std::vector<int>& members, int left, int columns) {
      for (int i = 0; i < int(members.size()); ++i)
        canvas.Paste(left + i % columns * layout.cell, top + i / columns * layout.picture,
                     CategoryPicture(renderer, source(members[i]), band.category, layout.cell,
                                     layout.picture));
    };
    paste(band.train, 0, layout.columns);
    paste(band.ood, split + layout.gap / 2, layout.rest);
    top += layout.Lines(band) * layout.picture;
  }
  canvas.Box(split - 1, head / 3.0, 2, height - 2 * head / 3.0, ink::kFaint);
  return sheet;
}

}  // namespace dexremoe
