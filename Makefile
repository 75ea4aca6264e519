# dexremoe: the graph of everything. `make help` lists the targets.

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.SUFFIXES:
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c

include mk/deps.mk
include mk/build.mk
include mk/test.mk
include mk/experiment.mk

.PHONY: help
help:  ## this list
	@printf 'dexremoe: in-hand reorientation with mixtures of experts, on CPUs.\n\nTargets:\n'
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  \1\t\2/' | expand -t 16
	@printf '\nVariables:\n'
	@grep -hE '^[A-Z]+ \?=.*## ' $(MAKEFILE_LIST) | sed -E 's/^([A-Z]+) \?= *(.*[^ ]) *## (.*)/  \1=\2\t\3/' | expand -t 28
