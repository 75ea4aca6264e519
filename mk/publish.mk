# `make publish`: what the repository shows of runs.

GROWN_RUNS = $(patsubst results/%/eval/growth/done,%,$(wildcard results/*/eval/growth/done))
LEARN_COLUMNS := successes_per_600,drop_rate,mean_angle,goal_angle

PUBLISHED_TABLES := $(foreach t,table1 categories ablation_experts ablation_gate,$(addprefix $(t).,md csv tex)) \
  methods.md stages.md specialists.md best_worst.md best_worst.csv sizes.md
PUBLISHED_FIGURES := $(addsuffix .png,objects parts hand hand_parts curves per_object tsne strip baselines adr \
  ablation_experts ablation_gate best_worst sorted hardest others push size samples)

.PHONY: publish
publish:  ## copy what tables and figures a run has to results/tables and paper_figs
	@mkdir -p results/tables paper_figs
	cp $(wildcard $(PUBLISHED_TABLES:%=$(OUT)/tables/%)) results/tables/
	cp $(wildcard $(PUBLISHED_FIGURES:%=$(OUT)/figures/%)) paper_figs/
	@for table in $(wildcard results/ablate/tables/ablate_recipe.md); do cp $$table results/tables/; done
	@for run in cube six; do for table in results/$$run*/tables/learned.md; do [ ! -f $$table ] || \
	  cp $$table results/tables/learned_$$(basename $$(dirname $$(dirname $$table))).md; done; done
	@runs=$$(ls -d results/{cube,six,desk}*/curves/base.csv 2>/dev/null | cut -d/ -f2 || true); \
	[ -z "$$runs" ] || for x in samples seconds; do \
	  $(BIN)/plot --kind=curves --x=$$x --columns=$(LEARN_COLUMNS) --out=$(OUT)/figures/learning_$$x \
	    --labels=$$(echo $$runs | tr ' ' ,) --in=$$(printf 'results/%s/curves/base.csv\n' $$runs | paste -sd,); \
	  cp $(OUT)/figures/learning_$$x.png paper_figs/; done
	$(if $(call grown,$(GROWN_RUNS)),$(BIN)/plot --kind=growth --in=$(call commas,$(call grown,$(GROWN_RUNS))) \
	  --labels=$(call commas,$(call grown_labels,$(GROWN_RUNS))) --out=$(OUT)/figures/growth && \
	  cp $(OUT)/figures/growth.png paper_figs/)
