# Library modules, tools and their dependency files.

# Bottom to top; a module includes only modules that stand before it (tests/repro checks this).
MODULES ?= base io geometry nn shape hand sim task policy rl eval render
TOOLS   ?= $(basename $(notdir $(wildcard tools/*.cpp)))
BUILD   ?= build

CXX      ?= g++
# Expanded when something is compiled, not when make starts: the packages may come with this run.
INCLUDES = $(addprefix -isystem ,$(wildcard /usr/include/pcl-*)) \
  $(patsubst -I%,-isystem %,$(shell pkg-config --cflags eigen3 hdf5-serial freetype2 mpi-c))
PKG_LIBS = $(shell pkg-config --libs hdf5-serial ode assimp ccd urdfdom fmt libpng libxxhash freetype2 mpi-c) \
  -lOSMesa -lhwy -lqhullcpp -lqhull_r -ldnnl -lspdlog \
  -lpcl_common -lpcl_filters -lpcl_features -lpcl_search -lpcl_kdtree -lpcl_io \
  $(if $(wildcard /usr/include/mujoco/mujoco.h),-lmujoco)

# One baseline architecture: the packaged PCL and Eigen code must agree on alignment.
# No -ffast-math: runs are reproducible bit for bit.
CXXFLAGS ?= -O2 -g1
DEX_CXXFLAGS = -std=c++20 -ffp-contract=off -fno-math-errno -Wall -Wextra -Werror=return-type \
  -DSPDLOG_COMPILED_LIB -DSPDLOG_FMT_EXTERNAL -Ilib $(INCLUDES) -MMD -MP
LIBS = $(PKG_LIBS) -lpthread -ldl

module_sources = $(shell find lib/$(1) -name '*.cpp' | sort)
module_objects = $(patsubst lib/%.cpp,$(BUILD)/obj/lib/%.o,$(call module_sources,$(1)))
ARCHIVES := $(foreach m,$(MODULES),$(if $(call module_sources,$(m)),$(BUILD)/lib/lib$(m).a))
LINK_ORDER = $(shell printf '%s\n' $(ARCHIVES) | tac)

.PHONY: build
build: $(TOOLS:%=$(BUILD)/bin/%)  ## compile every tool into build/bin/

define module_rules
$(BUILD)/lib/lib$(1).a: $(call module_objects,$(1))
	@mkdir -p $$(@D)
	@rm -f $$@
	@ar rcs $$@ $$^
endef
$(foreach m,$(MODULES),$(eval $(call module_rules,$(m))))

$(BUILD)/obj/%.o: %.cpp
	@mkdir -p $(@D)
	@echo '  CXX  $<'
	@$(CXX) $(DEX_CXXFLAGS) $(CXXFLAGS) -c $< -o $@

$(TOOLS:%=$(BUILD)/bin/%): $(BUILD)/bin/%: $(BUILD)/obj/tools/%.o $(ARCHIVES)
	@mkdir -p $(@D)
	@echo '  LINK $@'
	@$(CXX) $(LDFLAGS) -Wl,--as-needed $< $(LINK_ORDER) $(LIBS) -o $@

# The lanes engine's kernels: one source for all instruction sets, chosen when the program runs.
# Products and sums may fuse. clang 14 makes them a few percent faster than g++ 12; either will do.
KERNEL_CXX ?= $(if $(shell command -v clang++),clang++,$(CXX))
$(BUILD)/obj/lib/sim/lanes/lanes_kernel.o: lib/sim/lanes/lanes_kernel.cpp
	@mkdir -p $(@D)
	@echo '  CXX  $<  ($(KERNEL_CXX))'
	@$(KERNEL_CXX) $(DEX_CXXFLAGS) $(CXXFLAGS) -O3 -ffp-contract=fast -c $< -o $@

.SECONDARY:
-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)

.PHONY: clean
clean:  ## remove what was compiled (results, objects and meshes stay)
	rm -rf $(BUILD)
