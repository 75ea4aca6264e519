# What a run comes to: tables, figures, films.

# $(2) unless, with EXISTING=1, none of $(1) is there to make it of.
if_any = $(if $(strip $(1)),$(2))

TABLES := \
  $(call if_any,$(call evaluated,$(EVAL_FILES)),$(OUT)/tables/table1.md) \
  $(call if_any,$(call evaluated,$(CATEGORY_FILES)),$(OUT)/tables/categories.md) \
  $(call if_any,$(call trained_in,$(METHOD_FILES)),$(OUT)/tables/methods.md)
OBJECT_FIGURES := $(addprefix $(OUT)/figures/,objects.png parts.png hand.png hand_parts.png)
GATE_FIGURES := $(addprefix $(OUT)/figures/,tsne.png strip.png episode.mp4)
FIGURES := \
  $(call if_any,$(call trained_in,$(OUT)/gate.h5,$(CURVES)),$(OUT)/figures/curves.png) \
  $(call if_any,$(call trained_in,$(METHOD_FILES),$(METHOD_CURVES)),$(OUT)/figures/baselines.png) \
  $(call if_any,$(call trained_in,$(OUT)/baseline_adr.h5,$(ADR_CURVE)),$(OUT)/figures/adr.png) \
  $(call if_any,$(call evaluated,$(OURS_FILES)),$(OUT)/figures/per_object.png) \
  $(call if_any,$(call trained_in,$(OUT)/gate.h5),$(GATE_FIGURES)) $(OBJECT_FIGURES)
PRODUCTS := $(TABLES) $(FIGURES)

.PHONY: experiment
experiment: $(PRODUCTS)

# The ablations stand beside them once a variant is there.
ifdef EXISTING
TABLES  += $(call if_any,$(call evaluated,$(VARIANT_FILES)),$(ABLATION_TABLES))
FIGURES += $(call if_any,$(call evaluated,$(VARIANT_FILES)),$(ABLATION_FIGURES))
endif

# Everything that can be made of what is there; what cannot is named.
existing = +@$(MAKE) $(JOBS) --no-print-directory build && \
  $(MAKE) $(JOBS) --no-print-directory EXPERIMENT=1 EXISTING=1 $(1)

.PHONY: tables figures existing-tables existing-figures
tables: deps  ## tables of whatever is trained or evaluated; what is not is marked as missing
	$(call existing,existing-tables)
figures: deps  ## the same for figures
	$(call existing,existing-figures)
existing-tables: $(TABLES)
existing-figures: $(FIGURES)
