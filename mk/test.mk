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
