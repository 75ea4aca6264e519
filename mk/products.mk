# What a run comes to: tables, figures, films.

RUN_TABLES  := $(addprefix $(OUT)/tables/,table1.md categories.md methods.md)
RUN_FIGURES := $(addprefix $(OUT)/figures/,curves.png objects.png parts.png per_object.png tsne.png \
  baselines.png adr.png hand.png hand_parts.png strip.png episode.mp4)

# With EXISTING=1 a product is left out when none of these is there to make it of.
made_of_table1.md      := $(call evaluated,$(EVAL_FILES))
made_of_categories.md  := $(call evaluated,$(CATEGORY_FILES))
made_of_methods.md     := $(call trained_in,$(METHOD_FILES))
made_of_curves.png     := $(call trained_in,$(OUT)/gate.h5,$(CURVES))
made_of_baselines.png  := $(call trained_in,$(METHOD_FILES),$(METHOD_CURVES))
made_of_adr.png        := $(call trained_in,$(OUT)/baseline_adr.h5,$(ADR_CURVE))
made_of_per_object.png := $(call evaluated,$(OURS_FILES))
$(foreach p,tsne.png strip.png episode.mp4,$(eval made_of_$(p) := $(call trained_in,$(OUT)/gate.h5)))
$(foreach p,objects.png parts.png hand.png hand_parts.png,$(eval made_of_$(p) := $(OBJECTS)))
$(foreach p,$(ABLATION_TABLES) $(ABLATION_FIGURES),$(eval made_of_$(notdir $(p)) := $(call evaluated,$(VARIANT_FILES))))
can_be_made = $(foreach p,$(1),$(if $(strip $(made_of_$(notdir $(p)))),$(p)))

TABLES  := $(call can_be_made,$(RUN_TABLES) $(if $(EXISTING),$(ABLATION_TABLES)))
FIGURES := $(call can_be_made,$(RUN_FIGURES) $(if $(EXISTING),$(ABLATION_FIGURES)))
PRODUCTS := $(TABLES) $(FIGURES)

.PHONY: experiment
experiment: $(PRODUCTS)

existing = +@$(MAKE) $(JOBS) --no-print-directory build && \
  $(MAKE) $(JOBS) --no-print-directory EXPERIMENT=1 EXISTING=1 $(1)
# $(1): all that might be made
name_left_out = $(foreach p,$(filter-out $(PRODUCTS),$(1)),echo 'Left out, for nothing is there to make it of: $(p)';)

.PHONY: tables figures existing-tables existing-figures
tables: deps  ## tables of whatever is trained or evaluated; what is not is marked as missing
	$(call existing,existing-tables)
figures: deps  ## the same for figures
	$(call existing,existing-figures)
existing-tables: $(TABLES)
	@$(call name_left_out,$(RUN_TABLES) $(ABLATION_TABLES))
existing-figures: $(FIGURES)
	@$(call name_left_out,$(RUN_FIGURES) $(ABLATION_FIGURES))
