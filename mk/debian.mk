# `make objects-debian`: real meshes from Debian packages, as data/debian_objects.csv lists them with
# their licences. Packages are fetched and unpacked into meshes/debian/packages, not installed; the list
# names the versions that it was made with.

DEBIAN_LIST := data/debian_objects.csv
DEBIAN_MESHES := meshes/debian
DEBIAN_ARCHIVES = $(sort $(shell tail -n +2 $(DEBIAN_LIST) | cut -d, -f3))

.PHONY: objects-debian
objects-debian: deps  ## fetch 65 real meshes from Debian packages (300 MB), for OBJECTS=meshes/debian
	+@$(MAKE) $(JOBS) --no-print-directory $(DEBIAN_MESHES)/manifest.csv

$(DEBIAN_ARCHIVES:%=$(DEBIAN_MESHES)/packages/%): $(DEBIAN_MESHES)/packages/%:
	@mkdir -p $(@D)
	cd $(@D) && apt-get download $*
	rm -rf $@.tmp
	dpkg-deb -x $(@D)/$*_*.deb $@.tmp && rm $(@D)/$*_*.deb && mv $@.tmp $@

# A line of the list names a file of a package: `archive` as it is, or `member` of the archive; of OBJ
# files only the objects and groups whose names match `groups`, where that is not empty.
$(DEBIAN_MESHES)/manifest.csv: $(DEBIAN_LIST) | $(DEBIAN_ARCHIVES:%=$(DEBIAN_MESHES)/packages/%)
	@echo 'category,file,up_axis,licence,author,source' >$@.tmp
	@tail -n +2 $< | while IFS=, read -r category name package version archive member groups up licence author; do \
	  source=$(@D)/packages/$$package/$$archive path=$${member:-$$archive}; \
	  file=$$category/$$name.$${path##*.}; mkdir -p $(@D)/$$category; \
	  unpack() { if [ -n "$$member" ]; then bsdtar -xOf $$source "$$member"; else cat $$source; fi; }; \
	  choose() { if [ -n "$$groups" ]; then \
	    awk -v groups="$$groups" '/^[go] / { skip = $$2 !~ groups } !(skip && /^f /)'; else cat; fi; }; \
	  unpack | choose >$(@D)/$$file; \
	  echo "$$category,$$file,$$up,$$licence,$$author,$$package $$version $$path" >>$@.tmp; \
	done
	@mv $@.tmp $@
	@echo "$(@D): $$(($$(wc -l <$@) - 1)) meshes"
