// A figure drawn by gnuplot: its data and its script stand beside it, so that anyone can restyle
// it.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace dexremoe {

struct Figure {
  double width = 16, height = 10;  // cm
  std::string data;                // content of NAME.dat
  std::string script;              // gnuplot commands; the file is called data
};

// Adds a line down the right edge that names what could not be drawn; nothing for no names.
void NoteMissing(const std::vector<std::string>& names, Figure& figure);

// Writes STEM.dat, STEM.gp, STEM.png and STEM.pdf; equal figures give equal bytes. Throws Error
// with gnuplot's first complaint when it fails or is not installed; figures that stood there stay.
void WriteFigure(const std::string& stem, const Figure& figure);

// Colours that people with any colour vision tell apart (Okabe and Ito 2008), darkest use first;
// repeats after eight.
std::string PaletteColor(int index);
// The same colour with transparency 0 (opaque) .. 255, as gnuplot's "#AARRGGBB".
std::string PaletteColor(int index, int transparency);

// Distance of tics: 1, 2 or 5 times a power of ten, at most `most` of them over `range` > 0.
double NiceStep(double range, int most);

// Text as a gnuplot string or data column: quoted, quotes and line breaks replaced.
std::string GnuplotQuoted(const std::string& text);

}  // namespace dexremoe
