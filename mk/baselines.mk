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
ifndef EXISTING
$(FROM_BASE:%=$(OUT)/baseline_%.h5): $(OUT)/base.h5
$(BASELINES:%=$(OUT)/baseline_%.h5): $(OUT)/baseline_%.h5: $(READY) $(call settings,learning train_baseline) | $(BIN)/train_baseline
	$(call train,train_baseline --method=$* $(call from_base,$*))
endif

METHOD_FILES := $(OUT)/base.h5 $(BASELINES:%=$(OUT)/baseline_%.h5) $(OUT)/gate.h5
$(OUT)/tables/methods.md: $(call trained_in,$(METHOD_FILES)) | $(BIN)/list_methods
	$(BIN)/list_methods --missing --policies=$(call commas,$(METHOD_FILES)) --out=$@

# Success against samples of all methods, and how ADR's ranges went.
METHOD_CURVES := $(patsubst $(OUT)/%.h5,$(OUT)/curves/%.csv,$(METHOD_FILES))
$(OUT)/figures/baselines.png: $(call trained_in,$(METHOD_FILES),$(METHOD_CURVES)) | $(BIN)/plot
	$(BIN)/plot --kind=curves --missing --columns=successes_per_episode,successes_per_600,drop_rate,routing_entropy \
	  --in=$(call commas,$(METHOD_CURVES)) \
	  --labels="Base,$(BASELINE_LABELS),DexReMoE" --out=$(basename $@)
ADR_COLUMNS := size_high,mass_high,friction_low,friction_high,damping_high,stiffness_high,gravity_high,force_high
ADR_CURVE := $(OUT)/curves/baseline_adr.ranges.csv
$(OUT)/figures/adr.png: $(call trained_in,$(OUT)/baseline_adr.h5,$(ADR_CURVE)) | $(BIN)/plot
	$(BIN)/plot --kind=curves --smooth=0 --columns=$(ADR_COLUMNS) --in=$(ADR_CURVE) \
	  --labels=ADR --out=$(basename $@)
