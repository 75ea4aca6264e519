# Shipped weights, and `make reproduce`: all that follows from them, with nothing trained.

PRETRAINED := results/pretrained
REPRODUCED := results/reproduced

# What is shipped of a run: the policies of all tables, the shape network, and the learning curves,
# which nothing but training can make.
SHIPPED = $(wildcard $(patsubst %,$(OUT)/%.h5,shape_net $(METHODS) $(VARIANTS)))
SHIPPED_CURVES = $(sort $(wildcard $(CURVES) $(METHOD_CURVES) $(ADR_CURVE)))

.PHONY: pretrained
pretrained: deps  ## strip the policies of the run OUT to weights, for make reproduce: results/pretrained
	@[ -f $(OUT)/gate.h5 ] || { echo '$(OUT)/gate.h5 is not there: train first (make quick ablations SCALE=$(SCALE))' >&2; exit 1; }
	+@$(MAKE) $(JOBS) --no-print-directory $(BIN)/export_weights
	@rm -rf $(PRETRAINED).tmp && mkdir -p $(PRETRAINED).tmp/curves
	@cp $(call settings,run) $(PRETRAINED).tmp/settings.txt && cp $(SHIPPED_CURVES) $(PRETRAINED).tmp/curves/
	@echo 'file,method,samples,seed,sha256' >$(PRETRAINED).tmp/manifest.csv
	@seed=$$(sed -n 's/^SEED=//p' $(call settings,run)); \
	for file in $(notdir $(SHIPPED)); do weights=$(PRETRAINED).tmp/$$file; \
	  if [ $$file = shape_net.h5 ]; then cp $(OUT)/$$file $$weights; about=shape_net,,$$seed; \
	  else about=$$($(BIN)/export_weights --policy=$(OUT)/$$file --out=$$weights); fi; \
	  echo "$$file,$$about,$$(sha256sum <$$weights | cut -d' ' -f1)" >>$(PRETRAINED).tmp/manifest.csv; \
	done
	@rm -rf $(PRETRAINED) && mv $(PRETRAINED).tmp $(PRETRAINED)
	@du -sh $(PRETRAINED)

# The weights are there and whole.
.PHONY: shipped
shipped:
	@[ -f $(PRETRAINED)/manifest.csv ] || { echo '$(PRETRAINED) is empty: train a run (make quick ablations SCALE=small), then make pretrained SCALE=small' >&2; exit 1; }
	@tail -n +2 $(PRETRAINED)/manifest.csv | sed -E 's|^([^,]*),.*,([^,]*)$$|\2  $(PRETRAINED)/\1|' | sha256sum --check --quiet

# The settings that the weights were trained with; how they are checked is up to who calls.
RECORDED = $(shell sed "s/.*/'&'/" $(PRETRAINED)/settings.txt)

.PHONY: reproduce reproduced
reproduce: shipped deps  ## evaluate the shipped weights; all tables, figures and films of them, nothing trained
	+@$(MAKE) $(JOBS) --no-print-directory build
	@install -C -D -m 644 -t $(REPRODUCED) $(PRETRAINED)/*.h5  # what is there already keeps its time
	@install -C -D -m 644 -t $(REPRODUCED)/curves $(PRETRAINED)/curves/*.csv
	+@$(MAKE) $(JOBS) --no-print-directory EXPERIMENT=1 EXISTING=1 OUT=$(REPRODUCED) $(RECORDED) reproduced
reproduced: $(PRODUCTS) $(OBJECT_STUDIES)
	@$(call name_left_out,$(RUN_TABLES) $(RUN_FIGURES) $(ABLATION_TABLES) $(ABLATION_FIGURES))
	@printf '\nDone. Look at:\n'; printf '  %s\n' $^
