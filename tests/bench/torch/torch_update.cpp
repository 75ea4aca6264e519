// Times the PPO update on libtorch, for bench_learn, with random experience of the given sizes.
//
//   torch_update --workers=2 --envs=2048 --horizon=8 --minibatch=16384 --mini_epochs=3
//                --hidden=512,512 --precision=f32 --seconds=0.5
//
// prints one CSV line: libtorch version, BLAS in use, parameters, updates timed, seconds and
// processor seconds per update, peak memory (GiB). Exits 2 on wrong usage.
#include <dlfcn.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>

#include "ppo.h"

namespace torch_peer {
namespace {

[[noreturn]] void Usage(const std::string& what) {
  std::fprintf(stderr, "torch_update: %s\n", what.c_str());
  std::exit(2);
}

// --name=value words; names outside of `values` are refused.
void Parse(int argc, char** argv, std::map<std::string, std::string>& values) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const std::size_t equal = word.find('=');
    if (word.rfind("--", 0) != 0 || equal == std::string::npos)
      Usage("expected --name=value, found " + word);
    const auto found = values.find(word.substr(2, equal - 2));
    if (found == values.end()) Usage("unknown option " + word);
    found->second = word.substr(equal + 1);
  }
}

double Number(const std::string& name, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(value >= 0))
    Usage("--" + name + ": expected a number, found " + text);
  return value;
}

std::vector<int> Widths(const std::string& text) {
  std::vector<int> widths;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');)
    widths.push_back(static_cast<int>(Number("hidden", part)));
  return widths;
}

// Experience of a policy at its start: actions drawn from it, so that ratios begin at one.
Batch RandomBatch(const Sizes& s, int steps, int envs, const Shapes& shapes, Policy policy) {
  const torch::NoGradGuard no_grad;
  const std::int64_t rows = std::int64_t{steps} * envs;
  Batch b;
  b.rows = {torch::randn({rows, s.obs}), torch::randn({rows, s.phys}),
            torch::randint(shapes.feature.size(0), rows, torch::kInt64)};
  const auto out = policy->forward(shapes, b.rows);
  b.mean = out.mean;
  b.log_std = policy->log_std.detach().clone();
  b.action = b.mean + torch::exp(b.log_std) * torch::randn_like(b.mean);
  b.log_prob = LogProbability(b.action, b.mean, b.log_std);
  b.value = out.value.reshape({steps, envs});
  b.reward = torch::randn({steps, envs});
  b.done = (torch::rand({steps, envs}) < 0.01).to(torch::kFloat32);
  b.last_value = torch::randn({envs});
  return b;
}

double Seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Of all threads.
double ProcessorSeconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double PeakGib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / (1 << 20);
}

// Where the program's matrix products come from: folder and file of the library behind sgemm_.
std::string BlasName() {
  Dl_info info;
  void* product = dlsym(RTLD_DEFAULT, "sgemm_");
  if (product == nullptr || dladdr(product, &info) == 0) return "unknown";
  const auto path = std::filesystem::canonical(info.dli_fname);
  return (path.parent_path().filename() / path.filename()).string();
}

void Run(std::map<std::string, std::string>& values) {
  const auto number = [&](const char* name) { return Number(name, values[name]); };
  const auto whole = [&](const char* name) { return static_cast<int>(number(name)); };
  torch::set_num_threads(std::max(1, whole("workers")));
  torch::manual_seed(1);
  Sizes sizes;
  sizes.hidden = Widths(values["hidden"]);
  UpdateOptions options;
  options.minibatch = whole("minibatch");
  options.mini_epochs = whole("mini_epochs");
  options.bfloat16 = values["precision"] == "bf16";
  if (!options.bfloat16 && values["precision"] != "f32") Usage("--precision: expected f32 or bf16");
  if (sizes.hidden.empty() || options.minibatch < 1) Usage("--hidden, --minibatch: expected more");

  Policy policy(sizes);
  std::int64_t parameters = 0;
  for (const auto& p : policy->parameters()) parameters += p.numel();
  const Shapes shapes = {torch::randn({1, sizes.feature}), torch::eye(1, sizes.categories)};
  // The first products start threads and fill caches.
  UpdateOptions once = options;
  once.mini_epochs = 1;
  Learner(once, Policy(sizes)).Update(RandomBatch(sizes, 2, 1024, shapes, policy), shapes);

  const Batch batch = RandomBatch(sizes, whole("horizon"), whole("envs"), shapes, policy);
  Learner learner(options, policy);
  const double start = Seconds(), cpu = ProcessorSeconds();
  int updates = 0;
  do {
    learner.Update(batch, shapes);
    ++updates;
  } while (Seconds() - start < number("seconds"));
  const double spent = Seconds() - start, cpu_spent = ProcessorSeconds() - cpu;
  std::printf("%s,%s,%lld,%d,%.6f,%.6f,%.4f\n", TORCH_VERSION, BlasName().c_str(),
              static_cast<long long>(parameters), updates, spent / updates, cpu_spent / updates,
              PeakGib());
}

}  // namespace
}  // namespace torch_peer

int main(int argc, char** argv) {
  std::map<std::string, std::string> values = {
      {"workers", "1"},     {"envs", "2048"},      {"horizon", "8"},     {"minibatch", "16384"},
      {"mini_epochs", "3"}, {"hidden", "512,512"}, {"precision", "f32"}, {"seconds", "0.5"}};
  torch_peer::Parse(argc, argv, values);
  torch_peer::Run(values);
  return std::fflush(stdout) == 0 ? 0 : 1;
}
