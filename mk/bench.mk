# Benchmarks: tests/bench/*_bench.cpp make one Google Benchmark program.

BENCH_SOURCES := $(sort $(wildcard tests/bench/*_bench.cpp))

$(BUILD)/bench/bench: $(BENCH_SOURCES:%.cpp=$(BUILD)/obj/%.o) $(ARCHIVES)
	@mkdir -p $(@D)
	@echo '  LINK $@'
	@$(CXX) $(LDFLAGS) -Wl,--as-needed $(filter %.o,$^) $(LINK_ORDER) $(LIBS) \
	  -lbenchmark_main -lbenchmark -o $@

# The update on libtorch, for comparison, where Debian's libtorch-dev is installed (too large to
# ask for). Its products are as fast as the BLAS that stands behind libblas.so.3.
TORCH_INCLUDE := /usr/include/torch/csrc/api/include
TORCH_UPDATE = $(if $(wildcard $(TORCH_INCLUDE)/torch/torch.h),$(BUILD)/bench/torch_update)
TORCH_OBJECTS := $(patsubst %.cpp,$(BUILD)/obj/%.o,$(sort $(wildcard tests/bench/torch/*.cpp)))

$(TORCH_OBJECTS): DEX_CXXFLAGS += -isystem $(TORCH_INCLUDE)
$(BUILD)/bench/torch_update: $(TORCH_OBJECTS)
	@mkdir -p $(@D)
	@echo '  LINK $@'
	@$(CXX) $(LDFLAGS) $^ -ltorch_cpu -lc10 -ldl -o $@

# Convex parts by libHACD, for comparison, where Debian's libbullet-extras-dev is installed.
HACD_INCLUDE := /usr/include/bullet
HACD_PEER = $(if $(wildcard $(HACD_INCLUDE)/HACD/hacdHACD.h),$(BUILD)/bench/bench_hacd)
HACD_OBJECTS := $(patsubst %.cpp,$(BUILD)/obj/%.o,$(wildcard tests/bench/hacd/*.cpp))

$(HACD_OBJECTS): DEX_CXXFLAGS += -isystem $(HACD_INCLUDE)
$(BUILD)/bench/bench_hacd: $(HACD_OBJECTS) $(ARCHIVES)
	@mkdir -p $(@D)
	@echo '  LINK $@'
	@$(CXX) $(LDFLAGS) -Wl,--as-needed $(HACD_OBJECTS) $(LINK_ORDER) -lHACD $(LIBS) -o $@

# Meshes whose decomposition is measured: the built-in ones, and OBJECTS where it names a folder.
BENCH_MESHES := meshes/builtin$(if $(filter-out builtin,$(OBJECTS)),$(comma)$(OBJECTS))

.PHONY: bench
bench: deps  ## measure decomposition, speed and accuracy of the physics, speed of learning; writes results/bench/ (install libtorch-dev libopenblas0-openmp to compare with libtorch, libbullet-extras-dev with libHACD)
	+@$(MAKE) $(JOBS) --no-print-directory $(BUILD)/bench/bench $(TORCH_UPDATE) $(HACD_PEER) \
	  $(addprefix $(BUILD)/bin/,bench_decompose bench_sim validate_sim bench_learn make_objects) meshes/builtin/manifest.csv
	@mkdir -p results/bench
	$(BUILD)/bin/bench_decompose --meshes=$(BENCH_MESHES) --workers=$(WORKERS) $(HACD_PEER:%=--peer=%) --out=results/bench/decompose.md --csv=results/bench/decompose.csv
	$(BUILD)/bin/bench_sim --workers=$(WORKERS) --out=results/bench/sim.md --csv=results/bench/sim.csv
	$(BUILD)/bin/validate_sim --workers=$(WORKERS) --out=results/bench/validate_sim.md --csv=results/bench/validate_sim.csv
	@$(if $(TORCH_UPDATE),,echo 'Learning is not compared with libtorch: no $(TORCH_INCLUDE) (Debian package libtorch-dev).')
	$(BUILD)/bin/bench_learn --workers=$(WORKERS) $(TORCH_UPDATE:%=--peer=%) --out=results/bench/learn.md --csv=results/bench/learn.csv
	@$(BUILD)/bench/bench --benchmark_repetitions=3 --benchmark_report_aggregates_only=true \
	  --benchmark_out=results/bench/bench.json --benchmark_out_format=json \
	  --benchmark_counters_tabular=true | tee results/bench/bench.txt.tmp
	@mv results/bench/bench.txt.tmp results/bench/bench.txt
	@echo 'Written: results/bench/decompose.md, sim.md, validate_sim.md, learn.md, bench.txt, bench.json'

# PointNet++ at the paper's sizes, trained on the built-in training objects and tried on the others and
# on real meshes.
shape_objects = +@$(MAKE) $(JOBS) --no-print-directory EXPERIMENT=1 OBJECTS=$(2) OUT=results/shape-$(1) \
  CONFIG=data/config/paper.toml clouds

.PHONY: shape-table
shape-table: deps $(if $(filter $(DEBIAN_MESHES),$(REAL)),$(DEBIAN_MESHES)/manifest.csv)  ## categories told from clouds: built-in objects and REAL=DIR, f32 and bf16; writes results/bench/shape.md
	+@$(MAKE) $(JOBS) --no-print-directory build
	$(call shape_objects,builtin,builtin)
	$(call shape_objects,real,$(REAL))
	@mkdir -p results/bench
	$(BUILD)/bin/bench_shape --objects=results/shape-builtin/objects.csv --real=results/shape-real/objects.csv \
	  --workers=$(WORKERS) --out=results/bench/shape.md --csv=results/bench/shape.csv
