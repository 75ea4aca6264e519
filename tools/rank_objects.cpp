// The best and the worst objects of an evaluated policy: a table and a sheet of pictures.
#include <cstdio>

#include "base/error.h"
#include "base/options.h"
#include "eval/ranking.h"
#include "io/atomic_file.h"
#include "render/ranking_sheet.h"

namespace {

using namespace dexremoe;

struct RankOptions {
  std::string eval, trace, objects, split = "train", out, picture;
  double tolerance = 0.4;
  int count = 5, width = 1500;
  HandOptions hand;
  RenderOptions render;

  void Register(Options& options) {
    options.Add("eval", &eval, "evaluation (dexremoe.eval)").Required();
    options.Add("tolerance", &tolerance, "which tolerance, rad").Range(0, 3.15);
    options.Add("split", &split, "which objects").Choices({"train", "ood", "all"});
    options.Add("count", &count, "objects of either kind; at most half of them").Range(1, 100);
    options.Add("out", &out, "table without ending: OUT.md and OUT.csv are written")
        .Required()
        .NotStored();
    options.Add("picture", &picture, "sheet to draw (PNG); empty: none").NotStored();
    options.Add("objects", &objects, "objects.csv (picture)");
    options.Add("trace", &trace,
                "an episode of each object (picture): evaluate "
                "--trace_choice=typical");
    options.Add("width", &width, "pixels of the sheet").Range(100, 16384);
    hand.Register(options);
    render.Register(options);
  }
};

void Draw(const RankOptions& o, const Ranking& ranking) {
  if (o.objects.empty() || o.trace.empty())
    throw UsageError("--picture needs --objects=FILE and --trace=FILE");
  const std::vector<ObjectEntry> entries = ReadObjectList(o.objects);
  const HandModel hand = LoadHand(o.hand);
  const TraceFile trace = ReadTrace(o.trace);
  Renderer renderer(o.render);
  const Fonts fonts;
  WritePng(o.picture,
           RankingSheet(renderer, fonts, {ranking, entries, hand, trace, o.trace}, o.width));
}

void Run(const RankOptions& o) {
  const EvalFile eval = ReadEval(o.eval);
  const EvalRun* run = FindRun(eval, o.tolerance);
  if (run == nullptr)
    Fail("{}: expected an evaluation at tolerance {} rad, found none", o.eval, o.tolerance);
  const Ranking ranking = RankObjects(eval, *run, o.split, o.count);
  if (!o.picture.empty()) Draw(o, ranking);
  const std::string table = MarkdownOf(ranking);
  WriteFile(o.out + ".md", table);
  WriteFile(o.out + ".csv", CsvOf(ranking));
  std::fputs(table.c_str(), stdout);
}

}  // namespace

int main(int argc, char** argv) {
  RankOptions rank;
  Options options(
      "rank_objects",
      "Lists the objects that a policy turns best and worst and how their episodes end, "
      "and draws them.",
      "rank_objects --eval=eval/base.h5 --trace=trace/base.h5 --objects=objects.csv "
      "--out=tables/best_worst --picture=figures/best_worst.png");
  rank.Register(options);
  return RunTool(options, argc, argv, [&] { Run(rank); });
}
