# Tests: tests/MODULE/*_test.cpp make one GoogleTest program per module; names that contain "Slow"
# run only in test-slow.

TEST_MODULES ?= $(sort $(notdir $(patsubst %/,%,$(dir $(wildcard tests/*/*_test.cpp)))))
TEST_PROGRAMS := $(TEST_MODULES:%=$(BUILD)/tests/%_test)

test_sources = $(sort $(wildcard tests/$(1)/*_test.cpp))

define test_rules
$(BUILD)/tests/$(1)_test: $(patsubst %.cpp,$(BUILD)/obj/%.o,$(call test_sources,$(1))) $(ARCHIVES)
	@mkdir -p $$(@D)
	@echo '  LINK $$@'
	@$$(CXX) $$(LDFLAGS) -Wl,--as-needed $$(filter %.o,$$^) $$(LINK_ORDER) $$(LIBS) \
	  -lgmock -lgtest -lgtest_main -o $$@
endef
$(foreach m,$(TEST_MODULES),$(eval $(call test_rules,$(m))))

# Optional real inputs: make test OBJECTS=DIR HAND=FILE runs the tests on them, else they skip.
# Exported only when given: an empty variable is not an unset one.
export DEX_BIN := $(BUILD)/bin
ifneq ($(OBJECTS),builtin)
export DEX_REAL_MESHES := $(OBJECTS)
endif
ifneq ($(HAND),data/hand/gx11.urdf)
export DEX_REAL_HAND := $(HAND)
endif

.PHONY: test test-slow test-programs
test-programs: build $(TEST_PROGRAMS)
test: deps  ## compile and run the fast tests
	+@$(MAKE) $(JOBS) --no-print-directory test-programs
	@tests/run.sh '-*Slow*' $(TEST_PROGRAMS)
test-slow: deps  ## compile and run the slow tests
	+@$(MAKE) $(JOBS) --no-print-directory test-programs
	@tests/run.sh '*Slow*' $(TEST_PROGRAMS)
