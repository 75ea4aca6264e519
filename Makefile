# dexremoe: the graph of everything. `make help` lists the targets.

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.SUFFIXES:
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c

# What a user may set. The text behind ## is shown by `make help`.
OBJECTS ?= builtin#                ## builtin, or a folder CATEGORY/MESH with or without manifest.csv
REAL ?= meshes/debian#             ## real meshes that shape-table tries: a folder as for OBJECTS
ENGINE ?= lanes#                   ## physics engine of grasps and training: lanes, ode or mujoco
CHECK ?= ode#                      ## physics engine of evaluation
HAND ?= data/hand/gx11.urdf#       ## hand description
WORKERS ?= 0#                      ## threads (0: one per processor); results do not depend on it
SEED ?= 1#                         ## seed of everything random
LAUNCH ?= #                        ## starts trainings on several processes, e.g. "mpirun -n 4"
SCALE ?= quick#                    ## size of the run: quick, small, desk or paper
CONFIG ?= $(CONFIG_$(SCALE))#  ## sizes and hyper-parameters of all stages; a later file wins
OUT ?= results/$(SCALE)$(if $(filter builtin,$(OBJECTS)),,-$(notdir $(OBJECTS:%/=%)))#  ## folder of the run

# The configuration files of a size, a later one winning.
CONFIG_quick := data/config/desk.toml data/config/quick.toml
CONFIG_small := $(CONFIG_quick) data/config/small.toml
CONFIG_desk  := data/config/desk.toml data/config/fine_end.toml
CONFIG_paper := data/config/paper.toml

# Recursive calls use all processors unless the user gave -j.
JOBS = $(if $(findstring jobserver,$(MAKEFLAGS)),,-j$(shell nproc))

comma := ,
empty :=
space := $(empty) $(empty)
commas = $(subst $(space),$(comma),$(strip $(1)))

include mk/deps.mk
include mk/build.mk
include mk/test.mk
include mk/debian.mk
include mk/bench.mk
include mk/settings.mk
include mk/experiment.mk
include mk/baselines.mk
include mk/ablations.mk
include mk/studies.mk
include mk/products.mk
include mk/reproduce.mk
include mk/publish.mk
include mk/ablate_recipe.mk

.PHONY: help
help:  ## this list
	@printf 'dexremoe: in-hand reorientation with mixtures of experts, on CPUs.\n\nTargets:\n'
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  \1\t\2/' | expand -t 16
	@printf '\nVariables:\n'
	@grep -hE '^[A-Z]+ [?]=.*## ' Makefile | sed -E 's/^([A-Z]+) [?]= *([^#]*)# *## (.*)/  \1=\2\t\3/' \
	  | sed -E 's/=results.*\t/=results\/$$(SCALE)\t/' | expand -t 34
