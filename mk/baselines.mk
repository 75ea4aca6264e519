# The methods that the paper compares itself with, each trained on as many samples as ours takes in all
# (base, experts and gate). What each of them is stands in lib/rl/baseline.h; tables/methods.md lists
# them as their checkpoints say.

.PHONY: baselines baselined
baselines: deps  ## train every baseline and control of SCALE; called again, it goes on
	+@$(MAKE) $(JOBS) --no-print-directory build
	+@$(MAKE) $(JOBS) --no-print-directory EXPERIMENT=1 ready
	+@$(MAKE) -j1 --no-print-directory EXPERIMENT=1 baselined
baselined: $(BASELINES:%=$(OUT)/baseline_%.h5)

# These go on from the base policy, whose samples count as theirs.
FROM_BASE := res base_long
from_base = $(if $(filter $(1),$(FROM_BASE)),--base=$(OUT)/base.h5)
$(FROM_BASE:%=$(OUT)/baseline_%.h5): $(OUT)/base.h5

$(BASELINES:%=$(OUT)/baseline_%.h5): $(OUT)/baseline_%.h5: $(READY) | $(BIN)/train_baseline
	$(call train,train_baseline --method=$* $(call from_base,$*))

METHOD_FILES := $(OUT)/base.h5 $(BASELINES:%=$(OUT)/baseline_%.h5) $(OUT)/gate.h5
$(OUT)/tables/methods.md: $(METHOD_FILES) | $(BIN)/list_methods
	$(BIN)/list_methods --policies=$(call commas,$(METHOD_FILES)) --out=$@

# Success against samples of all methods, and how ADR's ranges went.
$(OUT)/figures/baselines.png: $(METHOD_FILES) | $(BIN)/plot
	$(BIN)/plot --kind=curves --columns=successes_per_episode,successes_per_600,drop_rate,routing_entropy \
	  --in=$(call commas,$(patsubst $(OUT)/%.h5,$(OUT)/curves/%.csv,$(METHOD_FILES))) \
	  --labels="Base,$(BASELINE_LABELS),DexReMoE" --out=$(basename $@)
ADR_COLUMNS := size_high,mass_high,friction_low,friction_high,damping_high,stiffness_high,gravity_high,force_high
$(OUT)/figures/adr.png: $(OUT)/baseline_adr.h5 | $(BIN)/plot
	$(BIN)/plot --kind=curves --smooth=0 --columns=$(ADR_COLUMNS) --in=$(OUT)/curves/baseline_adr.ranges.csv \
	  --labels=ADR --out=$(basename $@)
