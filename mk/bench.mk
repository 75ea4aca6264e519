# Benchmarks: tests/bench/*_bench.cpp make one Google Benchmark program.

BENCH_SOURCES := $(sort $(wildcard tests/bench/*_bench.cpp))

$(BUILD)/bench/bench: $(BENCH_SOURCES:%.cpp=$(BUILD)/obj/%.o) $(ARCHIVES)
	@mkdir -p $(@D)
	@echo '  LINK $@'
	@$(CXX) $(LDFLAGS) -Wl,--as-needed $(filter %.o,$^) $(LINK_ORDER) $(LIBS) \
	  -lbenchmark_main -lbenchmark -o $@

.PHONY: bench
bench: deps  ## measure physics, networks and learning; writes results/bench/
	+@$(MAKE) $(JOBS) --no-print-directory $(BUILD)/bench/bench
	@mkdir -p results/bench
	@$(BUILD)/bench/bench --benchmark_repetitions=3 --benchmark_report_aggregates_only=true \
	  --benchmark_out=results/bench/bench.json --benchmark_out_format=json \
	  --benchmark_counters_tabular=true | tee results/bench/bench.txt.tmp
	@mv results/bench/bench.txt.tmp results/bench/bench.txt
	@echo 'Written: results/bench/bench.txt, results/bench/bench.json'
