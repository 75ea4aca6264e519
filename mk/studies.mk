# The paper's studies, on whatever checkpoints a run has: best and worst objects, success per object,
# against pushes, sizes and samples, and the map of the gate. What is missing is named in
# tables/studies.md and in the figures; `make studies` called again adds it.
#
# Evaluations here take few episodes on lanes, except where they stand beside those of the table.

STUDY_EPISODES ?= 10
STUDY_STARTS   ?= 40
PUSHES         ?= 0 2 5 10 20
SIZES          ?= 0.6 0.7 0.8 0.9 1.0

.PHONY: studies studied
studies: deps  ## the paper's studies, on the checkpoints that are there
	+@$(MAKE) $(JOBS) --no-print-directory build
	+@$(MAKE) $(JOBS) --no-print-directory EXPERIMENT=1 studied
	@cat $(OUT)/tables/studies.md

label_untrained := Untrained
label_base      := Base policy
label_uniform   := Uniform average
label_gate      := DexReMoE
$(foreach b,$(BASELINES),$(eval label_baseline_$(b) := $(label_$(b))))
# Labels of these methods, separated by commas; they may hold spaces.
labels = $(subst ?, ,$(call commas,$(foreach m,$(1),$(subst $(space),?,$(label_$(m))))))
repeat = $(foreach m,$(1),$(2))

STUDIED := $(foreach m,$(METHODS),$(if $(wildcard $(OUT)/$(m).h5),$(m)))
MISSING := $(filter-out $(STUDIED),$(METHODS))
# The untrained network would only take room in figures. They name the others: plot is given the files
# that are not there as well.
SHOWN   := $(filter-out untrained,$(STUDIED))
GONE    := $(filter-out untrained,$(MISSING))
ABSENT  := $(GONE:%=$(OUT)/%.h5)
STUDY   := $(OUT)/eval/studies

# $(1): policy, $(2): objects.csv, $(3): more options
study = mkdir -p $(@D) && $(BIN)/evaluate $(COMMON) $(RUNS) $(check) $(check_lanes) \
  --eval.episodes=$(STUDY_EPISODES) --policy=$(1) --objects=$(2) $(3) --out=$@ >$(@:.h5=.txt)

$(STUDY)/episodes.txt: FORCE
	@$(call remember,echo '$(STUDY_EPISODES)')
$(STUDY)/methods.txt: FORCE
	@$(call remember,echo '$(SHOWN); $(PUSHES); $(SIZES)')
in = $(call commas,$(ABSENT) $(filter %.h5,$^))
# Success of all methods against a quantity. $(1): its name and unit, $(2): its values
plot_study = $(BIN)/plot --kind=study --x="$(1)" --missing --in=$(in) \
  --values=$(call commas,$(call repeat,$(GONE),0) $(call repeat,$(SHOWN),$(2))) \
  --labels="$(call labels,$(GONE) $(foreach m,$(SHOWN),$(call repeat,$(2),$(m))))" --out=$(basename $@)

# --- Objects ------------------------------------------------------------------------------------

# The five best and worst of the base policy. The same episodes as in the table, and a recorded one of each.
$(STUDY)/base.h5: $(OUT)/base.h5 $(CHECKED_BY) | $(BIN)/evaluate
	@mkdir -p $(@D) $(OUT)/trace
	$(BIN)/evaluate $(COMMON) --sim.engine=$(CHECK) $(RUNS) --eval.tolerances=0.4 --policy=$< --objects=$(OUT)/objects.csv \
	  --split=all --out=$@ --trace=$(OUT)/trace/typical.h5 --trace_choice=typical --trace_episodes=1000 >$(@:.h5=.txt)
$(OUT)/figures/best_worst.png: $(STUDY)/base.h5 | $(BIN)/rank_objects
	@mkdir -p $(@D) $(OUT)/tables
	$(BIN)/rank_objects --eval=$< --trace=$(OUT)/trace/typical.h5 --objects=$(OUT)/objects.csv --hand=$(HAND) \
	  --out=$(OUT)/tables/best_worst --picture=$@

# Success per object, all methods.
PER_OBJECT := sorted hardest others
$(PER_OBJECT:%=$(OUT)/figures/%.png): $(OUT)/figures/%.png: $(STUDY)/methods.txt $(SHOWN:%=$(OUT)/eval/%.h5) | $(BIN)/plot
	$(BIN)/plot --kind=$* --missing --in=$(in) --labels="$(call labels,$(GONE) $(SHOWN))" --seed=$(SEED) --out=$(basename $@)

OBJECT_STUDIES := $(addprefix $(OUT)/figures/,$(if $(filter base,$(STUDIED)),best_worst.png) \
  $(if $(SHOWN),$(PER_OBJECT:%=%.png)))

# --- Pushes -------------------------------------------------------------------------------------

PUSHED := $(foreach m,$(SHOWN),$(PUSHES:%=$(STUDY)/push/$(m)-%.h5))
define push_rule
$(STUDY)/push/$(1)-$(2).h5: $(OUT)/$(1).h5 $(STUDY)/episodes.txt | $(BIN)/evaluate
	$$(call study,$$<,$(OUT)/objects.csv,--eval.push=$(2))
endef
$(foreach m,$(SHOWN),$(foreach f,$(PUSHES),$(eval $(call push_rule,$(m),$(f)))))
$(OUT)/figures/push.png: $(STUDY)/methods.txt $(PUSHED) | $(BIN)/plot
	$(call plot_study,push (N),$(PUSHES))

# --- Sizes --------------------------------------------------------------------------------------

# The objects anew at every size, starts included. A size at which the hand finds no grasp of an object
# takes that object out of the study: all points are of the same objects.
SIZED := data/objects/$(RUN)-size
SIZED_OBJECTS := $(foreach s,$(SIZES),$(OBJECT_NAMES:%=$(SIZED)/$(s)/%))
define size_rule
$(SIZED)/$(1)/$(2)/mesh.h5: $(MESH_$(2)) $(call settings,objects) | $(BIN)/scale_mesh
	@mkdir -p $$(@D)
	$(BIN)/scale_mesh $(CONFIG:%=--config=%) --scale.scale=$(1) --mesh=$$< --name=$(2) --category=$(CATEGORY_$(2)) --out=$$@ >$$(@D)/scale.log
endef
$(foreach s,$(SIZES),$(foreach name,$(OBJECT_NAMES),$(eval $(call size_rule,$(s),$(name)))))

$(SIZED_OBJECTS:%=%/grasps.log): %/grasps.log: %/parts.h5 $(call settings,run) | $(BIN)/find_grasps
	@rm -f $*/grasps.h5
	$(BIN)/find_grasps $(COMMON) $(SIM) --grasp.count=$(STUDY_STARTS) --mesh=$*/mesh.h5 --parts=$< --out=$*/grasps.h5 >$@.tmp 2>&1 || \
	  grep -q 'no grasp found' $@.tmp || { cat $@.tmp; exit 1; }
	@mv $@.tmp $@
$(SIZES:%=$(SIZED)/%.csv): $(SIZED)/%.csv: $(OUT)/objects.csv $(SIZED_OBJECTS:%=%/grasps.log) $(SIZED_OBJECTS:%=%/shape.h5)
	@while IFS= read -r line; do name=$${line%%,*}; whole=1; \
	  for s in $(SIZES); do [ $$name = name ] || [ -f $(SIZED)/$$s/$$name/grasps.h5 ] || whole=; done; \
	  [ -z "$$whole" ] || printf '%s\n' "$${line//$(subst /,\/,$(OBJDIR))\//$(subst /,\/,$(SIZED)/$*)\/}"; \
	  done <$< >$@.tmp && mv $@.tmp $@

SIZE_FILES := $(foreach m,$(SHOWN),$(SIZES:%=$(STUDY)/size/$(m)-%.h5))
define size_study_rule
$(STUDY)/size/$(1)-$(2).h5: $(OUT)/$(1).h5 $(SIZED)/$(2).csv $(STUDY)/episodes.txt | $(BIN)/evaluate
	$$(call study,$$<,$(SIZED)/$(2).csv)
endef
$(foreach m,$(SHOWN),$(foreach s,$(SIZES),$(eval $(call size_study_rule,$(m),$(s)))))
$(OUT)/figures/size.png: $(STUDY)/methods.txt $(SIZE_FILES) | $(BIN)/plot
	$(call plot_study,size (1: 0.1 m long),$(SIZES))
$(OUT)/tables/sizes.md: $(SIZED_OBJECTS:%=%/grasps.log)
	@mkdir -p $(@D)
	@{ printf 'Starts found at each size; an object without any at one of them is left out of figures/size.png.\n\n'; \
	  printf '| object |'; printf ' %s |' $(SIZES); printf '\n|:--|'; for s in $(SIZES); do printf -- '--:|'; done; echo; \
	  for o in $(OBJECT_NAMES); do printf '| %s |' $$o; for s in $(SIZES); do \
	    printf ' %s |' $$(sed -n 's/^grasps *\([0-9]*\) of.*/\1/p' $(SIZED)/$$s/$$o/grasps.log | grep . || echo 0); done; echo; \
	  done; } >$@.tmp && mv $@.tmp $@

# --- Samples ------------------------------------------------------------------------------------

# The states on the way and the last one of every method. Ours starts as the base policy; the samples
# of the stages before count.
TRAINED   := $(filter-out uniform,$(SHOWN))
BEFORE_gate := $(OUT)/base.h5 $(EXPERT_FILES)
snapshots = $(basename $(notdir $(sort $(wildcard $(OUT)/snapshots/$(1)/*.h5))))
states    = $(addprefix $(STUDY)/growth/$(1)-,$(addsuffix .h5,$(call snapshots,$(1)) last))
define growth_rules
$(STUDY)/growth/$(1)-last.h5: $(OUT)/$(1).h5 $(STUDY)/episodes.txt | $(BIN)/evaluate
	$$(call study,$$<,$(OUT)/objects.csv,$(if $(BEFORE_$(1)),--earlier=$$(call commas,$(BEFORE_$(1)))))
$(addprefix $(STUDY)/growth/$(1)-,$(addsuffix .h5,$(call snapshots,$(1)))): $(STUDY)/growth/$(1)-%.h5: $(OUT)/snapshots/$(1)/%.h5 $(STUDY)/episodes.txt | $(BIN)/evaluate
	$$(call study,$$<,$(OUT)/objects.csv,$(if $(BEFORE_$(1)),--earlier=$$(call commas,$(BEFORE_$(1)))))
endef
$(foreach m,$(TRAINED),$(eval $(call growth_rules,$(m))))
GREW := $(foreach m,$(filter-out gate,$(TRAINED)),$(call states,$(m))) \
  $(if $(filter gate,$(TRAINED)),$(call states,base) $(call states,gate))
GREW_AS := $(foreach m,$(filter-out gate,$(TRAINED)),$(call repeat,$(call states,$(m)),$(m))) \
  $(if $(filter gate,$(TRAINED)),$(call repeat,$(call states,base) $(call states,gate),gate))
$(OUT)/figures/samples.png: $(STUDY)/methods.txt $(GREW) | $(BIN)/plot
	$(BIN)/plot --kind=growth --missing --in=$(call commas,$(filter-out %/uniform.h5,$(ABSENT)) $(GREW)) \
	  --labels="$(call labels,$(filter-out uniform,$(GONE)) $(GREW_AS))" --out=$(basename $@)

# --- All of them --------------------------------------------------------------------------------

# Product: checkpoints that it needs.
needs_best_worst := base
needs_tsne       := gate
$(foreach s,$(PER_OBJECT) push size samples,$(eval needs_$(s) := $(firstword $(SHOWN) base)))
ALL_STUDIES := best_worst $(PER_OBJECT) push size samples tsne
POSSIBLE := $(foreach s,$(ALL_STUDIES),$(if $(filter $(STUDIED),$(needs_$(s))),$(s)))
studied: $(POSSIBLE:%=$(OUT)/figures/%.png) $(if $(filter size,$(POSSIBLE)),$(OUT)/tables/sizes.md)
	@mkdir -p $(OUT)/tables
	@{ printf 'Methods: %s.\n' "$(call labels,$(STUDIED))"; printf 'Missing: %s.\n\n' "$(or $(call labels,$(MISSING)),none)"; \
	  printf '| study | |\n|:--|:--|\n'; $(foreach s,$(ALL_STUDIES),printf '| %s | %s |\n' $(s) \
	  $(if $(filter $(s),$(POSSIBLE)),figures/$(s).png,"missing: needs $(needs_$(s)).h5");) } >$(OUT)/tables/studies.md
