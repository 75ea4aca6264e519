# What a run was made with: $(OUT)/settings/run.txt holds its variables, check.txt the engine of
# evaluation, GROUP.txt the sections of $(CONFIG) that a group of stages reads. Each is rewritten only
# when its text changes, so that exactly what depends on it is remade: another number of episodes
# discards no training.

sections_objects  := load scale decompose cloud shape hand sim grasp task \
  list_objects scale_mesh sample_cloud train_shape describe_shape find_grasps
sections_learning := policy ppo random adr
sections_eval     := eval evaluate
$(foreach s,train_base train_expert train_gate train_baseline embed_gate,$(eval sections_$(s) := $(s)))
sections_embed_gate += tsne

# $(1): run, check or groups
settings = $(1:%=$(OUT)/settings/%.txt)

# Becomes $@ where it differs from it. $(1): command that prints the text
remember = mkdir -p $(@D) && $(1) >$@.tmp && if cmp -s $@.tmp $@; then rm $@.tmp; else mv $@.tmp $@; fi

.PHONY: FORCE
FORCE:
$(call settings,run): FORCE
	@$(call remember,printf '%s\n' 'OBJECTS=$(OBJECTS)' 'ENGINE=$(ENGINE)' 'HAND=$(HAND)' 'SEED=$(SEED)' 'CONFIG=$(CONFIG)')
$(call settings,check): FORCE
	@$(call remember,echo 'CHECK=$(CHECK)')
# Without comments and empty lines. (A text of its own: its commas would part arguments of a call.)
sections_of = awk -v groups=' $(sections_$(1)) ' '/^\[/ { wanted = index(groups, " " substr($$1, 2, index($$1, "]") - 2) " ") } \
  wanted { sub(/ *\#.*/, "") } wanted && NF' $(CONFIG)
$(call settings,%): $(CONFIG) FORCE
	@$(call remember,$(call sections_of,$*))
