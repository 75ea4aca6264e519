# `make ablations`: the paper's two ablations (IV-D). Every variant is a gate over experts of the same
# base, trained on the samples of our gate.
#
# Number of experts: 1 for all objects, ours of 4, 6 of a category each, 8 with the two largest
# categories halved by class (lib/task/object_groups.h). What our four train on in all is shared out
# among them.
# NOTE(paper): it does not say whether more experts get more samples.
# Input of the gate: full (ours), the cloud's embedding or the category alone; over our experts.

EXPERT_NUMBERS := 1 6 8
share_1 := 4
share_6 := 0.6667
share_8 := 0.5
GATE_INPUTS := cloud category
VARIANTS := $(EXPERT_NUMBERS:%=experts_%) $(GATE_INPUTS:%=input_%)

.PHONY: ablations ablated
ablations: deps $(filter quick,$(MAKECMDGOALS))  ## the paper's ablations: 1, 4, 6, 8 experts and the gate's inputs; trains what is not there
	+@$(MAKE) $(JOBS) --no-print-directory build
	+@$(MAKE) $(JOBS) --no-print-directory EXPERIMENT=1 ablated
	@printf '\nDone. Look at:\n'; printf '  %s\n' $(ABLATION_TABLES) $(ABLATION_FIGURES)

ABLATION_TABLES  := $(addprefix $(OUT)/tables/,ablation_experts.md ablation_gate.md)
ABLATION_FIGURES := $(addprefix $(OUT)/figures/,ablation_experts.png ablation_gate.png)
ablated: $(ABLATION_TABLES) $(ABLATION_FIGURES)

# $(1): how many experts
groups_of  = $(foreach i,$(shell seq $(1)),$(OUT)/ablation/objects_$(1)_$(i).csv)
experts_of = $(foreach i,$(shell seq $(1)),$(OUT)/ablation/expert_$(1)_$(i).h5)

define ablation_rules
$(call groups_of,$(1)) &: $(OUT)/objects.mk | $(BIN)/group_objects
	$(BIN)/group_objects --objects=$(OUT)/objects.csv --groups=$(1) --out=$(OUT)/ablation/objects_$(1)_
$(call experts_of,$(1)): $(OUT)/ablation/expert_%.h5: $(OUT)/base.h5 $(OUT)/ablation/objects_%.csv $(call settings,train_expert) | $(BIN)/train_expert
	$$(call train,train_expert --base=$$< --share=$(share_$(1)),$(OUT)/ablation/objects_$$*.csv)
$(OUT)/experts_$(1).h5: $(call experts_of,$(1)) $(call settings,train_gate) | $(BIN)/train_gate
	$$(call train,train_gate --experts=$$(call commas,$(call experts_of,$(1))))
endef

ifndef EXISTING
$(foreach n,$(EXPERT_NUMBERS),$(eval $(call ablation_rules,$(n))))
$(GATE_INPUTS:%=$(OUT)/input_%.h5): $(OUT)/input_%.h5: $(EXPERT_FILES) $(call settings,train_gate) | $(BIN)/train_gate
	$(call train,train_gate --experts=$(call commas,$(EXPERT_FILES)) --policy.gate_input=$*)
endif

VARIANT_FILES := $(VARIANTS:%=$(OUT)/eval/%.h5)
$(call evaluable,$(VARIANT_FILES)): $(OUT)/eval/%.h5: $(OUT)/%.h5 $(CHECKED_BY) | $(EVALUATE)
	@mkdir -p $(@D)
	$(BIN)/evaluate $(COMMON) --sim.engine=$(CHECK) $(RUNS) --policy=$< --objects=$(OUT)/objects.csv --split=all \
	  --out=$@ >$(@:.h5=.txt)

ablation_experts := $(foreach v,experts_1 gate experts_6 experts_8,$(OUT)/eval/$(v).h5)
labels_experts   := 1 expert,4 experts,6 experts,8 experts
ablation_gate    := $(foreach v,gate input_cloud input_category,$(OUT)/eval/$(v).h5)
labels_gate      := Full input,Cloud only,Category only

# The paper prints no numbers of its ablations; ours of four experts is its Table I's.
$(OUT)/tables/ablation_experts.md: $(call evaluated,$(ablation_experts))
$(OUT)/tables/ablation_gate.md: $(call evaluated,$(ablation_gate))
$(ABLATION_TABLES): $(OUT)/tables/ablation_%.md: data/paper_tables.csv | $(BIN)/tabulate
	$(BIN)/tabulate --missing --eval=$(call commas,$(ablation_$*)) --labels="$(labels_$*)" \
	  --paper=data/paper_tables.csv --paper_methods=DexReMoE --out=$(basename $@)

$(OUT)/figures/ablation_experts.png: $(call evaluated,$(ablation_experts))
$(OUT)/figures/ablation_gate.png: $(call evaluated,$(ablation_gate))
$(ABLATION_FIGURES): $(OUT)/figures/ablation_%.png: | $(BIN)/plot
	$(BIN)/plot --kind=ablation --missing --in=$(call commas,$(ablation_$*)) --labels="$(labels_$*)" \
	  --out=$(basename $@)
