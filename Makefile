# SPDX-License-Identifier: MIT
# nacre: `make help` lists the targets. A local Makefile.config may set the variables below.
-include Makefile.config

config ?= release
BUILD ?= build
CC ?= cc
AR ?= ar
PREFIX ?= /usr/local
DESTDIR ?=
ARM_CC ?= arm-none-eabi-gcc
CLANG ?= clang

VERSION := 0.1.0
SONAME := libnacre.so.0
O := $(BUILD)/$(config)

ifeq ($(config),release)
  CONFIG_FLAGS := -O2 -DNDEBUG
else ifeq ($(config),debug)
  CONFIG_FLAGS := -O0 -g -DNACRE_DEBUG
else ifeq ($(config),sanitize)
  CONFIG_FLAGS := -O1 -g -DNACRE_DEBUG -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
else
  $(error config=$(config): expected release, debug or sanitize)
endif

WARNINGS := -Wall -Wextra -Wshadow -Wmissing-prototypes -Wstrict-prototypes -Wvla -Wundef
ifdef werror
  WARNINGS += -Werror
endif
CFLAGS ?=
RUNTIME_FLAGS = -std=c99 -pedantic $(WARNINGS) $(CONFIG_FLAGS) -fPIC -ffunction-sections -MMD -MP $(CFLAGS)
HOST_FLAGS = -std=c11 -D_GNU_SOURCE $(WARNINGS) $(CONFIG_FLAGS) -fopenmp -MMD -MP $(CFLAGS)
HOST_LIBS := -lassimp -lcjson -lcminpack -lpng -lm -ldl

# V=1 shows the commands. Targets that build before they run use every core unless -j says otherwise.
ifdef V
  say = @:
else
  Q := @
  say = @echo "  $(1)"
endif
JOBS := $(if $(filter -j%,$(MAKEFLAGS)),,-j$(shell nproc 2>/dev/null || echo 2))
SUBMAKE = $(MAKE) --no-print-directory

# ---- rooms: each is built with -I for exactly the rooms it may include ---------------------------
ROOMS := fx asset shade soft gles
INC_fx := -Iinclude -Isrc/fx
INC_asset := -Iinclude -Isrc/asset -Isrc/fx
INC_shade := -Iinclude -Isrc/shade -Isrc/fx -Isrc/asset
INC_soft := -Iinclude -Isrc/soft -Isrc/fx -Isrc/asset -Isrc/shade
INC_gles := -Iinclude -Isrc/gles -Isrc/fx -Isrc/asset -Isrc/shade
INC_tools_lib := -Iinclude -Isrc/fx -Isrc/shade -Isrc/asset -Itools/lib -isystem tools/vendor/stb
INC_tools := -Iinclude -Isrc/fx -Isrc/shade -Isrc/asset -Itools/lib -Itools
INC_gen := -Iinclude -Isrc/fx -Isrc/shade -Isrc/gles -Itools/lib
INC_tests := -Iinclude $(ROOMS:%=-Isrc/%) -Itools/lib -Itools -Itests/support -isystem tools/vendor/stb

room_objects = $(patsubst src/%.c,$(O)/src/%.o,$(wildcard src/$(1)/*.c))
TEXTS := $(wildcard shaders_gles/*.glsl shaders_gles/*.vert shaders_gles/*.frag)
TEXT_OBJECTS := $(patsubst shaders_gles/%,$(O)/embedded/%.o,$(TEXTS))
RUNTIME_OBJECTS := $(foreach room,$(ROOMS),$(call room_objects,$(room))) $(TEXT_OBJECTS)

DATA := $(wildcard fixtures/in/*.csv)
DATA_OBJECTS := $(patsubst fixtures/in/%,$(O)/embedded/%.o,$(DATA))
TOOLS_LIB_OBJECTS := $(patsubst tools/lib/%.c,$(O)/tools/lib/%.o,$(wildcard tools/lib/*.c)) $(DATA_OBJECTS)
TOOL_OBJECTS := $(patsubst tools/%.c,$(O)/tools/%.o,$(filter-out tools/demo.c,$(wildcard tools/*.c)))

LIB := $(O)/libnacre.a
SHARED := $(O)/libnacre.so.$(VERSION)
TOOLS_LIB := $(O)/libnacretools.a
TOOL := $(O)/nacre
DEMO := $(O)/nacre-demo

UNIT := $(patsubst tests/%.c,$(O)/tests/%,$(wildcard tests/unit/test_*.c))
FRAME := $(patsubst tests/%.c,$(O)/tests/%,$(wildcard tests/frame/test_*.c))
FAULT := $(patsubst tests/%.c,$(O)/tests/%,$(wildcard tests/fault/test_*.c))
BUDGET := $(patsubst tests/%.c,$(O)/tests/%,$(wildcard tests/budget/test_*.c))
SUPPORT := $(patsubst tests/%.c,$(O)/tests/%.o,$(wildcard tests/support/*.c))

.PHONY: same-bits bare-metal all lib tool demo test tests check-long lint shaders sizes bench install clean help power-table deps-build deps-demo \
        deps-test deps-check-long run-tests sanitize-tests budget
.DELETE_ON_ERROR:
.SECONDARY:

## all: libnacre.a, libnacre.so and the program nacre (the default)
all: $(LIB) $(O)/libnacre.so $(TOOL)

$(LIB): $(RUNTIME_OBJECTS)
	@rm -f $@
	$(call say,ar $@)
	$(Q)$(AR) rcsD $@ $^

$(SHARED): $(RUNTIME_OBJECTS) src/libnacre.map
	$(call say,ld $@)
	$(Q)$(CC) -shared -Wl,-soname,$(SONAME) -Wl,--version-script=src/libnacre.map -Wl,--no-undefined $(CONFIG_FLAGS) \
	  -o $@ $(RUNTIME_OBJECTS) $(LDFLAGS)

$(O)/libnacre.so: $(SHARED)
	@ln -sf $(notdir $(SHARED)) $(O)/$(SONAME)
	@ln -sf $(SONAME) $@

$(TOOLS_LIB): $(TOOLS_LIB_OBJECTS)
	@rm -f $@
	$(call say,ar $@)
	$(Q)$(AR) rcsD $@ $^

$(TOOL): $(TOOL_OBJECTS) $(TOOLS_LIB) $(LIB)
	$(call say,ld $@)
	$(Q)$(CC) $(CONFIG_FLAGS) -fopenmp -o $@ $^ $(HOST_LIBS) $(LDFLAGS)

$(DEMO): $(O)/tools/demo.o $(TOOLS_LIB) $(LIB)
	$(call say,ld $@)
	$(Q)$(CC) $(CONFIG_FLAGS) -fopenmp -o $@ $^ $(HOST_LIBS) $(LDFLAGS)

define room_rule
$(O)/src/$(1)/%.o: src/$(1)/%.c Makefile
	@mkdir -p $$(@D)
	$$(call say,cc $$<)
	$(Q)$(CC) $$(RUNTIME_FLAGS) $(INC_$(1)) -c -o $$@ $$<
endef
$(foreach room,$(ROOMS),$(eval $(call room_rule,$(room))))

# Kernels for one instruction set stand in files of their own; others see empty ones. Their loops over planes and edges are
# worth unrolling.
ifeq ($(config),release)
$(O)/src/soft/kernels_%.o: RUNTIME_FLAGS += -O3
endif
ifneq (,$(filter x86_64% i386% i686%,$(shell $(CC) -dumpmachine 2>/dev/null)))
$(O)/src/soft/kernels_avx2.o: RUNTIME_FLAGS += -mavx2
$(O)/src/soft/kernels_sse41.o: RUNTIME_FLAGS += -msse4.1
endif

$(O)/tools/lib/%.o: tools/lib/%.c Makefile
	@mkdir -p $(@D)
	$(call say,cc $<)
	$(Q)$(CC) $(HOST_FLAGS) $(INC_tools_lib) -c -o $@ $<

$(O)/tools/%.o: tools/%.c Makefile
	@mkdir -p $(@D)
	$(call say,cc $<)
	$(Q)$(CC) $(HOST_FLAGS) $(INC_tools) -c -o $@ $<

# Generators run on the building machine, without sanitizers.
$(O)/gen/embed: tools/gen/embed.c Makefile
	@mkdir -p $(@D)
	$(call say,cc $<)
	$(Q)$(CC) -std=c11 -O1 $(WARNINGS) -o $@ $<

$(O)/embedded/%.c: shaders_gles/% $(O)/gen/embed
	@mkdir -p $(@D)
	$(Q)$(O)/gen/embed --shader $< >$@

$(O)/embedded/%.c: fixtures/in/% $(O)/gen/embed
	@mkdir -p $(@D)
	$(Q)$(O)/gen/embed $< >$@

$(O)/embedded/%.o: $(O)/embedded/%.c
	$(Q)$(CC) -std=c99 -O0 -fPIC -c -o $@ $<

## power-table: make src/shade/power_table.c again
power-table: $(O)/gen/power_table
	$< >src/shade/power_table.c
$(O)/gen/power_table: tools/gen/power_table.c Makefile
	@mkdir -p $(@D)
	$(call say,cc $<)
	$(Q)$(CC) -std=c11 -O1 $(WARNINGS) -o $@ $< -lm

$(O)/gen/shader_list: tools/gen/shader_list.c $(LIB) Makefile
	@mkdir -p $(@D)
	$(call say,cc $<)
	$(Q)$(CC) $(HOST_FLAGS) $(INC_gen) -o $@ $< $(LIB)

$(O)/gen/glsl_limits: tools/gen/glsl_limits.c Makefile
	@mkdir -p $(@D)
	$(call say,cc $<)
	$(Q)$(CC) $(HOST_FLAGS) $(INC_gen) -o $@ $<

# ---- seeing it -----------------------------------------------------------------------------------

## demo: bake and draw measured materials; pictures in out/
demo: deps-demo
	@$(SUBMAKE) $(JOBS) $(DEMO)
	@mkdir -p out
	$(DEMO) out

## shaders: every assembled shader text, in build/shaders/
shaders: $(BUILD)/shaders/.done
$(BUILD)/shaders/.done: $(O)/gen/shader_list
	@rm -rf $(@D) && mkdir -p $(@D)
	$(call say,shaders $(@D))
	$(Q)$< $(@D)
	@touch $@

## sizes: bytes of code, data, stack and public structs, x86-64 and Cortex-M4
sizes: $(LIB)
	@sh tests/budget/measure.sh $(BUILD) $(ARM_CC) $(LIB)

## bench: time per frame of the shaders on this machine's drivers
bench: all
	$(TOOL) bench

# ---- tests ---------------------------------------------------------------------------------------
$(O)/tests/%.o: tests/%.c Makefile
	@mkdir -p $(@D)
	$(call say,cc $<)
	$(Q)$(CC) $(HOST_FLAGS) $(INC_tests) -c -o $@ $<

$(O)/tests/%: $(O)/tests/%.o $(SUPPORT) $(TOOLS_LIB) $(LIB)
	$(call say,ld $@)
	$(Q)$(CC) $(CONFIG_FLAGS) -fopenmp -o $@ $^ -lcmocka $(HOST_LIBS) $(LDFLAGS)

tests: $(UNIT) $(FAULT) $(FRAME) $(BUDGET)

## test: all tests (release; readers and fault tests again under ASan + UBSan); ends with cmocka's lines
test: deps-test
	@$(SUBMAKE) $(JOBS) all tests $(BUILD)/shaders/.done budget $(DEMO)
	@$(SUBMAKE) $(JOBS) config=sanitize sanitize-tests
	@$(SUBMAKE) run-tests

sanitize-tests: $(TOOL) $(UNIT) $(FAULT)

run-tests:
	@sh tests/run.sh $(BUILD)

budget: $(LIB)
	@sh tests/budget/measure.sh $(BUILD) $(ARM_CC) $(LIB) >/dev/null

## check-long: what takes long: fuzzing, every byte value, big sweeps
check-long: deps-check-long
	@$(SUBMAKE) test
	@sh tests/check_long.sh $(BUILD)

C_FILES = $(wildcard include/*.h src/*/*.[ch] tools/*.[ch] tools/lib/*.[ch] tools/gen/*.[ch] tests/*/*.[ch] tests/*/*.cc)
## lint: formatting, warnings of two compilers as errors, cppcheck, every shader text against GLSL ES and its limits
lint: $(O)/gen/glsl_limits
	clang-format --dry-run -Werror $(C_FILES)
	@$(SUBMAKE) $(JOBS) BUILD=$(BUILD)/lint-gcc CC=gcc werror=1 all tests $(BUILD)/lint-gcc/release/nacre-demo
	@$(SUBMAKE) $(JOBS) BUILD=$(BUILD)/lint-clang CC=$(CLANG) werror=1 all tests $(BUILD)/lint-clang/release/nacre-demo
	cppcheck --quiet --std=c99 --enable=warning,performance,portability --inline-suppr --error-exitcode=1 \
	  --suppress=missingIncludeSystem --suppress=preprocessorErrorDirective -Iinclude $(ROOMS:%=-Isrc/%) -Itools/lib src tools/lib tools/*.c tools/gen
	@$(SUBMAKE) shaders
	@sh tests/lint_shaders.sh $(BUILD)/shaders $(O)/gen/glsl_limits

$(O)/bare_metal_scene: tests/bare_metal/make_scene.c $(TOOLS_LIB) $(LIB) Makefile
	@mkdir -p $(@D)
	$(call say,cc $<)
	$(Q)$(CC) $(HOST_FLAGS) $(INC_tests) -Itests/bare_metal -o $@ $< $(TOOLS_LIB) $(LIB) $(HOST_LIBS) $(LDFLAGS)

$(O)/dump_cases: tests/arch/dump_cases.c $(SUPPORT) $(TOOLS_LIB) $(LIB) Makefile
	@mkdir -p $(@D)
	$(call say,cc $<)
	$(Q)$(CC) $(HOST_FLAGS) $(INC_tests) -o $@ $< $(SUPPORT) $(TOOLS_LIB) $(LIB) -lcmocka $(HOST_LIBS) $(LDFLAGS)

## same-bits: frames of the CPU renderer on every processor that can be emulated here
same-bits: $(O)/dump_cases
	@sh tests/arch/run.sh $(BUILD)

## bare-metal: the teapot on emulated Cortex-M3, M4 and M7, compared with this machine's frame; instructions a pixel
bare-metal: $(O)/bare_metal_scene
	@sh tests/bare_metal/run.sh $(BUILD)

# ---- installing ----------------------------------------------------------------------------------

## install: headers, libraries and the program under $(DESTDIR)$(PREFIX)
install: all
	install -d $(DESTDIR)$(PREFIX)/include $(DESTDIR)$(PREFIX)/lib/pkgconfig $(DESTDIR)$(PREFIX)/bin
	install -m644 include/*.h $(DESTDIR)$(PREFIX)/include
	install -m644 $(LIB) $(DESTDIR)$(PREFIX)/lib
	install -m755 $(SHARED) $(DESTDIR)$(PREFIX)/lib
	ln -sf $(notdir $(SHARED)) $(DESTDIR)$(PREFIX)/lib/$(SONAME)
	ln -sf $(SONAME) $(DESTDIR)$(PREFIX)/lib/libnacre.so
	printf 'prefix=%s\nincludedir=$${prefix}/include\nlibdir=$${prefix}/lib\n\nName: nacre\nDescription: measured materials on small GPUs\nVersion: %s\nCflags: -I$${includedir}\nLibs: -L$${libdir} -lnacre\n' \
	  '$(PREFIX)' '$(VERSION)' >$(DESTDIR)$(PREFIX)/lib/pkgconfig/nacre.pc
	install -m755 $(TOOL) $(DESTDIR)$(PREFIX)/bin

## deps: install what the tests need (deps-demo: only what drawing needs)
deps: deps-test
deps-demo:
	@sh tools/deps.sh demo
deps-test:
	@sh tools/deps.sh test $(BUILD)
deps-check-long:
	@sh tools/deps.sh check-long $(BUILD)

## clean: remove build/ and out/
clean:
	rm -rf $(BUILD) out

## help: this list
help:
	@sed -n 's/^## //p' $(MAKEFILE_LIST)

-include $(wildcard $(O)/*/*.d $(O)/*/*/*.d)
