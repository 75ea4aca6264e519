#include "eval/figure.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "base/error.h"
#include "io/atomic_file.h"

extern char** environ;

namespace dexremoe {
namespace {

namespace fs = std::filesystem;

constexpr double kPngDotsPerInch = 180;

// Both formats from one script. The fonts keep their size in points whatever the format.
std::string FullScript(const std::string& name, const Figure& figure) {
  // gnuplot's PNG terminal counts 96 dots to the inch, its PDF terminal 72: the same size on paper.
  const double scale = kPngDotsPerInch / 96;
  return fmt::format(
      "# Restyle freely, then run: gnuplot {0}.gp\n"
      "if (!exists(\"out\")) out = \"{0}\"\n"
      "data = \"{0}.dat\"\n"
      "set encoding utf8\n"
      "do for [format in \"png pdf\"] {{\n"
      "if (format eq \"png\") {{\n"
      "  set terminal pngcairo noenhanced size {1:.0f},{2:.0f} font \"DejaVu Sans,9\" "
      "fontscale {3:.3g} linewidth {3:.3g} pointscale {3:.3g} background \"white\"\n"
      "}} else {{\n"
      "  set terminal pdfcairo noenhanced size {4:.3g}cm,{5:.3g}cm font \"DejaVu Sans,9\" "
      "fontscale 0.75 background \"white\"\n"
      "}}\n"
      "set output out.\".\".format\n"
      "set key reverse Left\n"
      "{6}"
      "unset output\n"
      "}}\n",
      name, figure.width / 2.54 * kPngDotsPerInch, figure.height / 2.54 * kPngDotsPerInch, scale,
      figure.width, figure.height, figure.script);
}

// Both ends of a pipe, closed at the end.
struct Pipe {
  int ends[2] = {-1, -1};
  Pipe() {
    if (pipe2(ends, O_CLOEXEC) != 0) Fail("gnuplot: no pipe: {}", std::strerror(errno));
  }
  ~Pipe() {
    CloseWriteEnd();
    close(ends[0]);
  }
  void CloseWriteEnd() {
    if (ends[1] >= 0) close(ends[1]);
    ends[1] = -1;
  }
};

// Runs gnuplot in `folder`; returns what it said on stderr. Throws Error when it cannot be started
// or fails.
std::string RunGnuplot(const std::string& folder, const std::vector<std::string>& arguments,
                       const std::string& stem) {
  Pipe pipe;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe.ends[1], STDERR_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  std::vector<char*> argv = {const_cast<char*>("gnuplot")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const int code = posix_spawnp(&child, "gnuplot", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (code != 0)
    Fail("{}: gnuplot cannot be started: {} (Debian package gnuplot-nox)", stem,
         std::strerror(code));
  pipe.CloseWriteEnd();
  std::string said;
  char buffer[4096];
  for (ssize_t got = 0; (got = read(pipe.ends[0], buffer, sizeof buffer)) > 0;)
    said.append(buffer, static_cast<std::size_t>(got));
  int status = 0;
  waitpid(child, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    Fail("{}: gnuplot failed: {}", stem, said.substr(0, 500));
  return said;
}

// Cairo stamps PDF files with the time; equal figures must give equal bytes.
void FixPdfDate(const std::string& path) {
  std::string bytes = ReadFile(path);
  const std::string key = "/CreationDate (D:", fixed = "20000101000000";
  const std::size_t at = bytes.find(key);
  if (at == std::string::npos || at + key.size() + fixed.size() > bytes.size()) return;
  bytes.replace(at + key.size(), fixed.size(), fixed);
  WriteFile(path, bytes);
}

}  // namespace

void NoteMissing(const std::vector<std::string>& names, Figure& figure) {
  if (names.empty()) return;
  const std::string text = fmt::format("missing: {}", fmt::join(names, ", "));
  figure.data = fmt::format("# {}\n", text) + figure.data;
  figure.script =
      fmt::format(
          "set label {} at screen 0.985,0.99 right rotate by 90 front font \",7\" textcolor rgb "
          "\"#707070\"\n",
          GnuplotQuoted(text)) +
      figure.script;
}

void WriteFigure(const std::string& stem, const Figure& figure) {
  const fs::path path(stem);
  const std::string name = path.filename().string();
  const std::string folder = path.has_parent_path() ? path.parent_path().string() : ".";
  WriteFile(stem + ".dat", figure.data);
  WriteFile(stem + ".gp", FullScript(name, figure));
  const std::string temporary = name + ".drawing";
  const std::string said =
      RunGnuplot(folder, {"-e", "out=" + GnuplotQuoted(temporary), name + ".gp"}, stem);
  for (const char* ending : {".png", ".pdf"}) {
    const std::string drawn = (fs::path(folder) / (temporary + ending)).string();
    std::error_code code;
    if (!fs::exists(drawn) || fs::file_size(drawn, code) == 0)
      Fail("{}{}: gnuplot drew nothing: {}", stem, ending, said.substr(0, 500));
    if (ending == std::string(".pdf")) FixPdfDate(drawn);
    CommitTemporary(drawn, stem + ending);
  }
}

std::string PaletteColor(int index, int transparency) {
  static constexpr std::array<const char*, 8> kColors = {"0072B2", "D55E00", "009E73", "CC79A7",
                                                         "E69F00", "56B4E9", "4D4D4D", "B8A800"};
  const char* color = kColors[static_cast<std::size_t>(index) % kColors.size()];
  return transparency == 0 ? fmt::format("#{}", color)
                           : fmt::format("#{:02X}{}", transparency, color);
}

std::string PaletteColor(int index) { return PaletteColor(index, 0); }

double NiceStep(double range, int most) {
  const double power = std::pow(10, std::floor(std::log10(range / most)));
  for (const double step : {1, 2, 5})
    if (step * power * most >= range) return step * power;
  return 10 * power;
}

std::string GnuplotQuoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? '\'' : (c == '\n' || c == '\\') ? ' ' : c;
  return out + '"';
}

}  // namespace dexremoe
