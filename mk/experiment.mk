# The experiment: from meshes to tables, figures and films. `make quick` runs all of it at small size.
#
# A run lives in $(OUT); what it makes of its objects in data/objects/$(RUN)/NAME/. Stages depend on
# their inputs and on the settings that they read (mk/settings.mk); tools are order-only, so that a
# rebuilt tool never discards a training.

RUN    := $(notdir $(OUT))
BIN    := $(BUILD)/bin
MESHES := $(if $(filter builtin,$(OBJECTS)),meshes/builtin,$(OBJECTS))
OBJDIR := data/objects/$(RUN)
COMMON := $(CONFIG:%=--config=%) --seed=$(SEED)
RUNS   := --hand=$(HAND) --workers=$(WORKERS)
SIM    := --sim.engine=$(ENGINE) $(RUNS)

.PHONY: quick
quick: deps  ## meshes to tables, figures and films at small size (about ten minutes)
	+@$(MAKE) $(JOBS) --no-print-directory build
	+@$(MAKE) $(JOBS) --no-print-directory EXPERIMENT=1 experiment
	@printf '\nDone. Look at:\n'; printf '  %s\n' $(PRODUCTS)

# The trainings alone, at any size. Objects are made side by side, trainings run one after another:
# each takes all processors (or, with LAUNCH, all machines).
.PHONY: train ready trained
train: deps  ## train base, experts and gate (SCALE=quick, desk or paper); called again, it goes on
	+@$(MAKE) $(JOBS) --no-print-directory build
	+@$(MAKE) $(JOBS) --no-print-directory EXPERIMENT=1 ready
	+@$(MAKE) -j1 --no-print-directory EXPERIMENT=1 trained
	@printf 'Trained: %s\nWatch with: tensorboard --logdir %s\n' $(OUT)/gate.h5 $(OUT)/tensorboard

.PHONY: stages
stages: deps  ## compare base, experts and gate of a run: tables/stages.md and, by category, specialists.md
	+@$(MAKE) $(JOBS) --no-print-directory build
	+@$(MAKE) -j1 --no-print-directory EXPERIMENT=1 $(OUT)/tables/stages.md $(OUT)/tables/specialists.md

.PHONY: gallery
gallery: deps  ## draw contact sheets of all objects, their parts and clouds: results/RUN/gallery/
	+@$(MAKE) $(JOBS) --no-print-directory build
	+@$(MAKE) $(JOBS) --no-print-directory EXPERIMENT=1 $(OUT)/gallery/index.txt
	@sed 's|^|  $(OUT)/gallery/|' $(OUT)/gallery/index.txt

# The learning checks: a base policy by the desk recipe and a fine end against the open-loop hold and
# the untrained network, on every engine. SEED=2 makes a second run beside the first.
seeded = results/$(1)$(if $(filter 1,$(SEED)),,-seed$(SEED))
learn_config = $(patsubst %,data/config/%.toml,desk $(1) fine_end)
LEARN = +@$(MAKE) $(JOBS) --no-print-directory EXPERIMENT=1 learned

.PHONY: cube six learned
cube: deps  ## train on a single cube by the desk recipe and check it on every engine (an hour)
	+@$(MAKE) $(JOBS) --no-print-directory build
	$(BIN)/make_objects --recipes=data/shapes --out=meshes/shapes
	$(LEARN) OBJECTS=meshes/shapes OUT=$(call seeded,cube) CONFIG="$(call learn_config,cube)"
six: deps  ## the same on one mesh of each category of OBJECTS (an hour)
	+@$(MAKE) $(JOBS) --no-print-directory build
	$(LEARN) OUT=$(call seeded,six) CONFIG="$(call learn_config,six)"
learned: $(OUT)/tables/learned.md $(OUT)/figures/base.png $(OUT)/figures/growth.png

# All objects, whatever the run takes of them.
.PHONY: dataset
dataset: deps  ## draw all objects: training left of a line, out of distribution right of it
	+@$(MAKE) $(JOBS) --no-print-directory build
	+@$(MAKE) $(JOBS) --no-print-directory $(OUT)/figures/dataset.png
	@mkdir -p paper_figs
	cp $(OUT)/figures/dataset.png paper_figs/

# With EXISTING=1 (make tables, figures, reproduce) nothing is trained: the rules that train are not
# there, and tables and figures are made of what is. Without it these lists stay whole.
# $(1): evaluations eval/NAME.h5, of policies NAME.h5
policy_of  = $(OUT)/$(patsubst gate_%,gate,$(basename $(notdir $(1)))).h5
evaluable  = $(if $(EXISTING),$(foreach f,$(1),$(if $(wildcard $(call policy_of,$(f))),$(f))),$(1))
evaluated  = $(if $(EXISTING),$(foreach f,$(1),$(if $(wildcard $(f) $(call policy_of,$(f))),$(f))),$(1))
# $(1): checkpoints; $(2): other files of their trainings, where they are what is used
trained_in = $(if $(EXISTING),$(wildcard $(or $(2),$(1))),$(1))

# --- Objects ------------------------------------------------------------------------------------

meshes/builtin/manifest.csv: $(wildcard data/recipes/*/* data/recipes/*.*) | $(BIN)/make_objects
	$(BIN)/make_objects --out=$(@D)

# objects.mk names the objects of the run; make reads it once it is there (see the include below).
$(OUT)/objects.mk: $(call settings,run objects) \
    $(if $(filter builtin,$(OBJECTS)),meshes/builtin/manifest.csv) | $(BIN)/list_objects
	$(BIN)/list_objects $(COMMON) --meshes=$(MESHES) --folder=$(OBJDIR) --makefile=$@ \
	  --out=$(OUT)/objects.csv

ifdef EXPERIMENT
include $(OUT)/objects.mk
endif
OBJECT_FILES = $(foreach name,$(OBJECT_NAMES),$(OBJDIR)/$(name)/$(1).h5)

define object_rules
$(OBJDIR)/$(1)/mesh.h5: $(MESH_$(1)) $(call settings,objects) | $(BIN)/scale_mesh
	@mkdir -p $$(@D)
	$(BIN)/scale_mesh $(CONFIG:%=--config=%) --mesh=$$< --name=$(1) --category=$(CATEGORY_$(1)) --out=$$@ >$$(@D)/scale.log
endef
$(foreach name,$(OBJECT_NAMES),$(eval $(call object_rules,$(name))))

# Wherever a mesh.h5 stands: $(OBJDIR), or the sizes of mk/studies.mk.
data/objects/%/parts.h5: data/objects/%/mesh.h5 | $(BIN)/decompose
	$(BIN)/decompose $(CONFIG:%=--config=%) --mesh=$< --out=$@ >$(@D)/decompose.log
data/objects/%/cloud.h5: data/objects/%/mesh.h5 | $(BIN)/sample_cloud
	$(BIN)/sample_cloud $(COMMON) --mesh=$< --out=$@ >$(@D)/cloud.log
data/objects/%/shape.h5: data/objects/%/cloud.h5 $(OUT)/shape_net.h5 | $(BIN)/describe_shape
	$(BIN)/describe_shape --net=$(OUT)/shape_net.h5 --cloud=$< --out=$@ >$(@D)/shape.log
data/objects/%/grasps.h5: data/objects/%/parts.h5 $(call settings,run) | $(BIN)/find_grasps
	$(BIN)/find_grasps $(COMMON) $(SIM) --mesh=$(@D)/mesh.h5 --parts=$< --out=$@ | tee $(@D)/grasps.log

ifndef EXISTING
$(OUT)/shape_net.h5: $(OUT)/objects.mk $(call OBJECT_FILES,cloud) | $(BIN)/train_shape
	$(BIN)/train_shape $(COMMON) --workers=$(WORKERS) --objects=$(OUT)/objects.csv --out=$@
endif

READY := $(OUT)/objects.mk $(call OBJECT_FILES,parts) $(call OBJECT_FILES,shape) $(call OBJECT_FILES,grasps)

ready: $(READY)

.PHONY: clouds
clouds: $(OUT)/objects.mk $(call OBJECT_FILES,cloud)

# --- Training -----------------------------------------------------------------------------------
# A training writes its checkpoints to NAME.running.h5 and takes up from there after a kill. NAME.h5
# is the last state; NAME.best.h5 the best one: highest successes per episode at the hardest task
# that the curriculum reached; snapshots/NAME/SAMPLES.h5 are states on the way.

# $(1): tool and its inputs; $(2): list of objects, where it is not that of the run
train = mkdir -p $(OUT)/curves && \
  $(LAUNCH) $(BIN)/$(1) $(COMMON) $(SIM) --objects=$(or $(2),$(OUT)/objects.csv) --out=$(@:.h5=.running.h5) --resume \
    --best=$(@:.h5=.best.h5) --snapshots=$(OUT)/snapshots/$(basename $(notdir $@)) --curve=$(OUT)/curves/$(notdir $(@:.h5=.csv)) \
    --tensorboard=$(OUT)/tensorboard/$(basename $(notdir $@)) && mv $(@:.h5=.running.h5) $@

EXPERTS := generalist airplane train animal
expert_categories_generalist := airplane,animal,head,shoe,train,vehicle
expert_categories_airplane := airplane
expert_categories_train := train
expert_categories_animal := animal
EXPERT_FILES := $(EXPERTS:%=$(OUT)/expert_%.h5)

ifndef EXISTING
$(OUT)/base.h5: $(READY) $(call settings,learning train_base) | $(BIN)/train_base
	$(call train,train_base)
$(EXPERT_FILES): $(OUT)/expert_%.h5: $(OUT)/base.h5 $(call settings,train_expert) | $(BIN)/train_expert
	$(call train,train_expert --base=$< --categories=$(expert_categories_$*))
$(OUT)/gate.h5: $(EXPERT_FILES) $(call settings,train_gate) | $(BIN)/train_gate
	$(call train,train_gate --experts=$(call commas,$(EXPERT_FILES)))

trained: $(OUT)/gate.h5

# Controls: the network as initialised, and the experts without a gate.
$(OUT)/untrained.h5: $(READY) | $(BIN)/train_base
	$(call train,train_base --samples=0)
$(OUT)/uniform.h5: $(EXPERT_FILES) | $(BIN)/train_gate
	$(call train,train_gate --experts=$(call commas,$(EXPERT_FILES)) --policy.gate_uniform --samples=0)
endif

# --- Evaluation ---------------------------------------------------------------------------------

# In the order of the paper's table, with its names; then the controls and ours.
BASELINES := dr privfeat privshape adr res sparse_moe switch mlore mmoe base_long
label_dr := DR
label_privfeat := PrivFeat
label_privshape := PrivShape
label_adr := ADR
label_res := Res
label_sparse_moe := SparseMoE
label_switch := Switch
label_mlore := MLoRE
label_mmoe := MMoE
label_base_long := Longer base
BASELINE_LABELS := $(subst ?,,$(subst $(space)?,$(comma),$(strip $(foreach b,$(BASELINES),?$(label_$(b))))))
METHODS := untrained base $(BASELINES:%=baseline_%) uniform gate
LABELS  := Untrained,Base policy,$(BASELINE_LABELS),Uniform average,DexReMoE
OURS    := untrained base uniform gate
EVAL_FILES := $(METHODS:%=$(OUT)/eval/%.h5)

# The objects come with the trainings; where there are none they are asked for.
OBJECTS_READY := $(if $(EXISTING),$(READY))
EVALUATE := $(BIN)/evaluate $(OBJECTS_READY)
CHECKED_BY := $(call settings,check eval)

$(call evaluable,$(EVAL_FILES)): $(OUT)/eval/%.h5: $(OUT)/%.h5 $(CHECKED_BY) | $(EVALUATE)
	@mkdir -p $(@D)
	$(BIN)/evaluate $(COMMON) --sim.engine=$(CHECK) $(RUNS) --policy=$< --objects=$(OUT)/objects.csv --split=all --out=$@ \
	  --trace=$(OUT)/trace/$*.h5 >$(OUT)/eval/$*.txt

$(OUT)/tables/table1.md: $(call evaluated,$(EVAL_FILES)) data/paper_tables.csv | $(BIN)/tabulate
	$(BIN)/tabulate --missing --eval=$(call commas,$(EVAL_FILES)) --labels="$(LABELS)" \
	  --paper=data/paper_tables.csv --out=$(basename $@)

# Without a label: the gate's policy told what PointNet++ takes each object for, or how likely it
# finds every category.
UNLABELLED := predicted soft
UNLABELLED_FILES := $(UNLABELLED:%=$(OUT)/eval/gate_%.h5)
$(call evaluable,$(UNLABELLED_FILES)): $(OUT)/eval/gate_%.h5: $(OUT)/gate.h5 $(CHECKED_BY) | $(EVALUATE)
	@mkdir -p $(@D)
	$(BIN)/evaluate $(COMMON) --sim.engine=$(CHECK) $(RUNS) --eval.category=$* --policy=$< \
	  --objects=$(OUT)/objects.csv --split=all --out=$@ >$(@:.h5=.txt)
CATEGORY_FILES := $(OUT)/eval/gate.h5 $(UNLABELLED_FILES)
$(OUT)/tables/categories.md: $(call evaluated,$(CATEGORY_FILES)) | $(BIN)/tabulate
	$(BIN)/tabulate --missing --eval=$(call commas,$(CATEGORY_FILES)) --labels="Category by label,Predicted category,Probabilities" \
	  --out=$(basename $@)

# A base policy on every engine. MuJoCo at about 1 ms is the referee, where it is installed.
CHECKED := lanes ode $(if $(wildcard /usr/include/mujoco/mujoco.h),mujoco)
check := --eval.tolerances=0.4 --split=all
check_lanes  := --sim.engine=lanes
check_ode    := --sim.engine=ode
check_mujoco := --sim.engine=mujoco --sim.substeps=16
CHECK_FILES := $(CHECKED:%=$(OUT)/eval/%.h5)
$(CHECK_FILES): $(OUT)/eval/%.h5: $(OUT)/base.h5 $(call settings,eval) | $(BIN)/evaluate
	@mkdir -p $(@D)
	$(BIN)/evaluate $(COMMON) $(RUNS) $(check) $(check_$*) --policy=$< \
	  --objects=$(OUT)/objects.csv --out=$@ >$(@:.h5=.txt)

# The least that a policy has to beat.
CONTROLS := $(OUT)/eval/hold.h5 $(OUT)/eval/start.h5
$(OUT)/eval/start.h5: $(OUT)/untrained.h5
$(CONTROLS): $(OUT)/eval/%.h5: $(READY) $(call settings,eval) | $(BIN)/evaluate
	@mkdir -p $(@D)
	$(BIN)/evaluate $(COMMON) $(RUNS) $(check) $(check_lanes) --policy=$(if $(filter hold,$*),hold,$(OUT)/untrained.h5) \
	  --objects=$(OUT)/objects.csv --out=$@ >$(@:.h5=.txt)
$(OUT)/tables/learned.md: $(CONTROLS) $(CHECK_FILES) | $(BIN)/tabulate
	$(BIN)/tabulate --engines --eval=$(call commas,$^) --out=$(basename $@) \
	  --labels="Open-loop hold,Untrained,$(call commas,$(CHECKED:%=Base:%))"

# The stages side by side: what experts and gate add to the base, on lanes and, at fewer episodes, on
# ODE; and what each expert is worth on each category.
stages_lanes := base expert_generalist uniform gate
stages_ode   := base gate
SPECIALISTS  := base $(EXPERTS:%=expert_%) gate
SPECIALIST_LABELS := Base policy,Generalist expert,Airplane expert,Train expert,Animal expert,DexReMoE
SPECIALIST_FILES  := $(SPECIALISTS:%=$(OUT)/eval/stages/%_lanes.h5)
check_stages_ode := --eval.episodes=10 --eval.tolerances=0.4
STAGE_FILES := $(foreach e,lanes ode,$(stages_$(e):%=$(OUT)/eval/stages/%_$(e).h5))
# $(1): engine; $(2): policies
define stage_rule
$(2:%=$(OUT)/eval/stages/%_$(1).h5): $(OUT)/eval/stages/%_$(1).h5: $(OUT)/%.h5 $(call settings,eval) | $(BIN)/evaluate
	@mkdir -p $$(@D)
	$(BIN)/evaluate $(COMMON) $(RUNS) --split=all $(check_$(1)) $(check_stages_$(1)) --policy=$$< \
	  --objects=$(OUT)/objects.csv --out=$$@ >$$(@:.h5=.txt)
endef
$(eval $(call stage_rule,lanes,$(sort $(stages_lanes) $(SPECIALISTS))))
$(eval $(call stage_rule,ode,$(stages_ode)))
$(OUT)/tables/stages.md: $(STAGE_FILES) | $(BIN)/tabulate
	$(BIN)/tabulate --engines --eval=$(call commas,$(STAGE_FILES)) --out=$(basename $@) \
	  --labels="Base policy:lanes,Generalist expert:lanes,Uniform average:lanes,DexReMoE:lanes,Base policy:ode,DexReMoE:ode"
$(OUT)/tables/specialists.md: $(SPECIALIST_FILES) | $(BIN)/tabulate
	$(BIN)/tabulate --categories --eval=$(call commas,$^) --labels="$(SPECIALIST_LABELS)" --out=$(basename $@)

$(OUT)/tsne.h5: $(OUT)/gate.h5 $(OUT)/shape_net.h5 $(call settings,embed_gate) | $(BIN)/embed_gate $(OBJECTS_READY)
	$(BIN)/embed_gate $(COMMON) --workers=$(WORKERS) --gate=$< --net=$(OUT)/shape_net.h5 \
	  --objects=$(OUT)/objects.csv --out=$@

# --- Figures ------------------------------------------------------------------------------------

CURVES := $(patsubst %,$(OUT)/curves/%.csv,base $(EXPERTS:%=expert_%) gate)
$(OUT)/figures/curves.png: $(call trained_in,$(OUT)/gate.h5,$(CURVES)) | $(BIN)/plot
	$(BIN)/plot --kind=curves --missing --in=$(call commas,$(CURVES)) --labels="Base,Generalist,Airplane,Train,Animal,Gate" \
	  --out=$(basename $@)
$(OUT)/figures/base.png: $(OUT)/base.h5 | $(BIN)/plot
	$(BIN)/plot --kind=curves --in=$(OUT)/curves/base.csv --labels="Base" --out=$(basename $@)
# The states on the way, each evaluated on the paper's task. $(1): runs; their evaluations and labels
# stand in the same order.
grown = $(foreach r,$(1),$(sort $(wildcard results/$(r)/eval/growth/*.h5)))
grown_labels = $(foreach r,$(1),$(patsubst %,$(r),$(wildcard results/$(r)/eval/growth/*.h5)))
$(OUT)/eval/growth/done: $(OUT)/base.h5 $(call settings,eval) | $(BIN)/evaluate
	@mkdir -p $(@D)
	for policy in $(OUT)/snapshots/base/*.h5; do \
	  $(BIN)/evaluate $(COMMON) $(RUNS) $(check) $(check_lanes) --policy=$$policy \
	    --objects=$(OUT)/objects.csv --out=$(@D)/$$(basename $$policy) >/dev/null; done
	@touch $@
$(OUT)/figures/growth.png: $(OUT)/eval/growth/done | $(BIN)/plot
	$(BIN)/plot --kind=growth --in=$(call commas,$(call grown,$(RUN))) \
	  --labels=$(call commas,$(call grown_labels,$(RUN))) --out=$(basename $@)
OURS_FILES := $(OURS:%=$(OUT)/eval/%.h5)
$(OUT)/figures/per_object.png: $(call evaluated,$(OURS_FILES)) | $(BIN)/plot
	$(BIN)/plot --kind=bars --missing --in=$(call commas,$(OURS_FILES)) --labels="Untrained,Base policy,Uniform average,DexReMoE" \
	  --out=$(basename $@)
$(OUT)/figures/tsne.png: $(OUT)/tsne.h5 | $(BIN)/plot
	$(BIN)/plot --kind=tsne --in=$< --out=$(basename $@)
$(OUT)/figures/objects.png: $(OUT)/objects.mk $(call OBJECT_FILES,mesh) | $(BIN)/render
	$(BIN)/render --kind=objects --objects=$(OUT)/objects.csv --out=$@
$(OUT)/dataset.csv: $(call settings,run objects) \
    $(if $(filter builtin,$(OBJECTS)),meshes/builtin/manifest.csv) | $(BIN)/list_objects
	$(BIN)/list_objects $(COMMON) --per_category=0 --meshes=$(MESHES) --folder=$(OBJDIR) --out=$@
$(OUT)/figures/dataset.png: $(OUT)/dataset.csv | $(BIN)/render
	$(BIN)/render --kind=dataset --objects=$< --out=$@
$(OUT)/figures/parts.png: $(OUT)/objects.mk $(call OBJECT_FILES,parts) | $(BIN)/render
	$(BIN)/render --kind=parts --objects=$(OUT)/objects.csv --out=$@
$(OUT)/gallery/index.txt: $(OUT)/objects.mk $(call OBJECT_FILES,parts) $(call OBJECT_FILES,cloud) | $(BIN)/render
	$(BIN)/render --kind=gallery --objects=$(OUT)/objects.csv --out=$(@D)
$(OUT)/figures/hand.png: $(HAND) $(call settings,run) | $(BIN)/render
	$(BIN)/render --kind=hand --hand=$(HAND) --out=$@
$(OUT)/figures/hand_parts.png: $(HAND) $(call settings,run) | $(BIN)/render
	$(BIN)/render --kind=hand_parts --hand=$(HAND) --out=$@
$(OUT)/figures/strip.png: $(OUT)/eval/gate.h5 | $(BIN)/render
	$(BIN)/render --kind=strip --hand=$(HAND) --trace=$(OUT)/trace/gate.h5 --objects=$(OUT)/objects.csv --out=$@
$(OUT)/figures/episode.mp4: $(OUT)/eval/gate.h5 | $(BIN)/render
	$(BIN)/render --kind=video --last=299 --hand=$(HAND) --trace=$(OUT)/trace/gate.h5 --objects=$(OUT)/objects.csv --out=$@
