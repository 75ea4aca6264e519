# `make ablate-recipe`: which parts of the desk recipe earn their place. Each is switched off in turn, on the cube of
# `make cube`, over several seeds, without the fine end; the table shows the deterministic policies on the paper's task.
# Trainings run side by side, each on one thread, and say how far they are in NAME-SEED.log.

ABLATE_SAMPLES ?= 30000000
ABLATE_SEEDS   ?= 1 2

switch_all                := #
switch_no_progress_reward := --task.c_progress=0
switch_no_fall_penalty    := --task.c_fall=0
switch_no_end_of_jams     := --task.goal_timeout=0
switch_no_jam_penalty     := --task.c_jam=0
switch_no_near_goals      := --task.near_share=0
switch_near_goals_first   := --task.near_share=0 --ppo.near_share_start=0.5
switch_no_curriculum      := --ppo.curriculum=false
switch_goal_as_it_is      := --task.goal_shown=3.1416
switch_60_decisions       := --task.action_repeat=1 --ppo.gamma=0.9967
switch_actions_shown      := --task.observe=action
switch_no_goal_vector     := --task.extra_inputs=joint_speed,tip_position,tip_contact,wait_clock
switch_no_joint_speed     := --task.extra_inputs=goal_vector,tip_position,tip_contact,wait_clock
switch_no_tip_position    := --task.extra_inputs=goal_vector,joint_speed,tip_contact,wait_clock
switch_no_tip_contact     := --task.extra_inputs=goal_vector,joint_speed,tip_position,wait_clock
switch_no_clock           := --task.extra_inputs=goal_vector,joint_speed,tip_position,tip_contact
switch_point_contacts     := --task.torsion_range=0,0
switch_friction_1         := --task.friction_range=0.9,1.1

ALL_SWITCHES := $(sort $(patsubst switch_%,%,$(filter switch_%,$(.VARIABLES))))
SWITCHES ?= $(ALL_SWITCHES)
ABLATED  := $(foreach s,$(SWITCHES),$(foreach n,$(ABLATE_SEEDS),$(OUT)/$(s)-$(n)))

.PHONY: ablate-recipe ablated-recipe
ablate-recipe: deps  ## train the cube without each part of the desk recipe in turn (hours)
	$(foreach s,$(filter-out $(ALL_SWITCHES),$(SWITCHES)),$(error SWITCHES: expected some of $(ALL_SWITCHES); found $(s)))
	+@$(MAKE) $(JOBS) --no-print-directory build
	$(BIN)/make_objects --recipes=data/shapes --out=meshes/shapes
	+@$(MAKE) $(JOBS) --no-print-directory EXPERIMENT=1 OBJECTS=meshes/shapes OUT=results/ablate WORKERS=1 \
	  CONFIG="data/config/desk.toml data/config/cube.toml" ablated-recipe
ablated-recipe: $(OUT)/tables/ablate_recipe.md

# NAME-SEED.h5 from the switch and seed in its name; the curves lie beside it.
switch_of = $(switch_$(firstword $(subst -, ,$(1))))
seed_of   = $(lastword $(subst -, ,$(1)))
$(ABLATED:%=%.h5): $(OUT)/%.h5: $(READY) | $(BIN)/train_base
	$(BIN)/train_base $(CONFIG:%=--config=%) --seed=$(call seed_of,$*) $(SIM) $(call switch_of,$*) \
	  --samples=$(ABLATE_SAMPLES) --objects=$(OUT)/objects.csv --out=$(OUT)/$*.running.h5 --resume \
	  --curve=$(OUT)/$*.csv >$(OUT)/$*.log 2>&1 || { cat $(OUT)/$*.log; exit 1; }
	mv $(OUT)/$*.running.h5 $@
$(ABLATED:%=%.eval.h5): $(OUT)/%.eval.h5: $(OUT)/%.h5 | $(BIN)/evaluate
	$(BIN)/evaluate $(COMMON) $(RUNS) $(check) $(check_lanes) $(filter --task.%,$(call switch_of,$*)) --policy=$< \
	  --objects=$(OUT)/objects.csv --out=$@ >$(@:.h5=.txt)

# A row for the episodes of all seeds and one for each of them.
of_seeds      = $(ABLATE_SEEDS:%=$(OUT)/$(1)-%.eval.h5)
ablate_files  = $(foreach s,$(SWITCHES),$(call of_seeds,$(s)) $(call of_seeds,$(s)))
ablate_labels = $(foreach s,$(SWITCHES),$(foreach n,$(ABLATE_SEEDS),$(s)) $(ABLATE_SEEDS:%=$(s):seed%))
$(OUT)/ablated.txt: FORCE
	@$(call remember,echo '$(SWITCHES); $(ABLATE_SEEDS)')
$(OUT)/tables/ablate_recipe.md: $(OUT)/ablated.txt $(ABLATED:%=%.eval.h5) | $(BIN)/tabulate
	@mkdir -p $(@D)
	$(BIN)/tabulate --engines --eval=$(call commas,$(ablate_files)) --labels=$(call commas,$(ablate_labels)) \
	  --out=$(basename $@)
