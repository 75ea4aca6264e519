# Benchmarks: tests/bench/*_bench.cpp make one Google Benchmark program.

BENCH_SOURCES := $(sort $(wildcard tests/bench/*_bench.cpp))

$(BUILD)/bench/bench: $(BENCH_SOURCES:%.cpp=$(BUILD)/obj/%.o) $(ARCHIVES)
	@mkdir -p $(@D)
	@echo '  LINK $@'
	@$(CXX) $(LDFLAGS) -Wl,--as-needed $(filter %.o,$^) $(LINK_ORDER) $(LIBS) \
	  -lbenchmark_main -lbenchmark -o $@

.PHONY: bench
bench: deps  ## measure speed and accuracy of the physics, and networks; writes results/bench/
	+@$(MAKE) $(JOBS) --no-print-directory $(BUILD)/bench/bench $(BUILD)/bin/bench_sim $(BUILD)/bin/validate_sim
	@mkdir -p results/bench
	$(BUILD)/bin/bench_sim --workers=$(WORKERS) --out=results/bench/sim.md --csv=results/bench/sim.csv
	$(BUILD)/bin/validate_sim --workers=$(WORKERS) --out=results/bench/validate_sim.md --csv=results/bench/validate_sim.csv
	@$(BUILD)/bench/bench --benchmark_repetitions=3 --benchmark_report_aggregates_only=true \
	  --benchmark_out=results/bench/bench.json --benchmark_out_format=json \
	  --benchmark_counters_tabular=true | tee results/bench/bench.txt.tmp
	@mv results/bench/bench.txt.tmp results/bench/bench.txt
	@echo 'Written: results/bench/sim.md, validate_sim.md, bench.txt, bench.json'
