# SPDX-License-Identifier: GPL-3.0-or-later
# The library for other programs, install, uninstall and dist; part of the Makefile.
PREFIX ?= /usr/local
bindir ?= $(PREFIX)/bin
libdir ?= $(PREFIX)/lib
includedir ?= $(PREFIX)/include
datadir ?= $(PREFIX)/share
# Of the Python module, and where it looks for the library first.
pythondir ?= $(datadir)/stdfit
python_library ?= $(libdir)/$(soname)
NM ?= nm
OBJCOPY ?= objcopy
export NM

library_folders := src data_readers fit/error fit/search fit/api
library_objects := $(filter $(foreach f,$(library_folders),$(patsubst %.c,$(BUILD)/%.o,$(wildcard $(f)/*.c))) \
	%/kernel_avx2.o %/kernel_avx512.o,$(lib_objects))
# What the public header declares is exported, and nothing else.
public_headers := fit/stdfit.h
shared := libstdfit.so.$(VERSION)
soname := libstdfit.so.$(firstword $(subst ., ,$(VERSION)))

library: $(BUILD)/libstdfit.a $(BUILD)/$(shared) $(BUILD)/python/stdfit.py

$(BUILD)/stdfit.exports: $(library_objects) $(public_headers) scripts/exports.sh
	$(call quiet,LIST)$(CC) $(ALL_CFLAGS) -E fit/stdfit.h | scripts/exports.sh $(library_objects) >$@.part && mv -f $@.part $@

# -Bsymbolic: the library calls its own functions even if a program has some of the same name.
$(BUILD)/$(shared): $(library_objects) $(BUILD)/stdfit.exports
	@{ echo '{ global:'; sed 's/$$/;/' $(BUILD)/stdfit.exports; echo 'local: *; };'; } >$(BUILD)/stdfit.map
	$(call quiet,LD)$(CC) $(ALL_CFLAGS) $(LDFLAGS) -shared -Wl,-soname,$(soname) -Wl,-Bsymbolic \
		-Wl,--version-script=$(BUILD)/stdfit.map -Wl,--as-needed -o $@ $(library_objects) $(LIBRARY_LIBS)

# One object, in which only the public names are global.
$(BUILD)/libstdfit.a: $(library_objects) $(BUILD)/stdfit.exports
	$(call quiet,AR)$(CC) -r -nostdlib -o $(BUILD)/libstdfit.o $(library_objects) && \
		$(OBJCOPY) --keep-global-symbols=$(BUILD)/stdfit.exports $(BUILD)/libstdfit.o && \
		rm -f $@ && $(AR) rcs $@ $(BUILD)/libstdfit.o

# The module with the declarations of the header in it; `make install` writes where the library is.
$(BUILD)/python/stdfit.py: scripts/stdfit.py $(public_headers) Makefile scripts/install.mk
	@mkdir -p $(@D)
	@$(CC) -E -P -DSTDFIT_CFFI $(public_headers) >$(BUILD)/stdfit.declarations
	$(call quiet,WRITE)sed -e '/^@DECLARATIONS@$$/{r $(BUILD)/stdfit.declarations' -e 'd;}' -e 's,@VERSION@,$(VERSION),' $< \
		>$@.part && mv -f $@.part $@

# put MODE,FILES,FOLDER[/NAME]
put = install -m $(1) $(2) "$(DESTDIR)$(3)"

install: all library
	install -d $(foreach d,$(bindir) $(libdir)/pkgconfig $(includedir)/stdfit $(datadir)/man/man1 \
		$(datadir)/bash-completion/completions $(datadir)/zsh/site-functions $(pythondir),"$(DESTDIR)$(d)")
	$(call put,755,$(BUILD)/stdfit,$(bindir))
	$(call put,755,$(BUILD)/$(shared),$(libdir))
	ln -sf $(shared) "$(DESTDIR)$(libdir)/$(soname)"
	ln -sf $(shared) "$(DESTDIR)$(libdir)/libstdfit.so"
	$(call put,644,$(BUILD)/libstdfit.a,$(libdir))
	$(call put,644,$(public_headers),$(includedir)/stdfit)
	sed 's,@PREFIX@,$(PREFIX),; s,@LIBDIR@,$(libdir),; s,@INCLUDEDIR@,$(includedir),; s,@VERSION@,$(VERSION),; s,@REQUIRES@,$(PKGS),' \
		scripts/stdfit.pc.in >$(BUILD)/stdfit.pc
	$(call put,644,$(BUILD)/stdfit.pc,$(libdir)/pkgconfig)
	$(call put,644,$(BUILD)/stdfit.1,$(datadir)/man/man1)
	$(call put,644,$(BUILD)/completions/stdfit.bash,$(datadir)/bash-completion/completions/stdfit)
	$(call put,644,$(BUILD)/completions/_stdfit,$(datadir)/zsh/site-functions)
	sed 's,@LIBRARY@,$(python_library),' $(BUILD)/python/stdfit.py >$(BUILD)/stdfit.py
	$(call put,644,$(BUILD)/stdfit.py,$(pythondir))

uninstall:
	rm -f $(foreach f,$(bindir)/stdfit $(addprefix $(libdir)/,$(shared) $(soname) libstdfit.so libstdfit.a pkgconfig/stdfit.pc) \
		$(addprefix $(includedir)/stdfit/,$(notdir $(public_headers))) $(datadir)/man/man1/stdfit.1 \
		$(datadir)/bash-completion/completions/stdfit $(datadir)/zsh/site-functions/_stdfit $(pythondir)/stdfit.py,"$(DESTDIR)$(f)")
	for d in "$(DESTDIR)$(includedir)/stdfit" "$(DESTDIR)$(pythondir)"; do \
		[ ! -d "$$d" ] || rmdir --ignore-fail-on-non-empty "$$d"; done

# The archive builds and tests on its own. It holds the files of the project alone: measured data may be in the same folder.
dist_files := .ci .clang-format .clang-tidy .cppcheck .editorconfig .gitignore CITATION.cff CONTRIBUTING.md LICENSE \
	Makefile NEWS.md README.md debian \
	$(sort $(foreach f,$(folders),$(firstword $(subst /, ,$(f))))) docs scripts tests
dist:
	@mkdir -p $(BUILD)
	tar -c --sort=name --owner=0 --group=0 --numeric-owner --exclude='*~' --transform='s,^,stdfit-$(VERSION)/,' \
		$(dist_files) | gzip -n >$(BUILD)/stdfit-$(VERSION).tar.gz

# Debian's packages, of the tarball, in BUILD/deb; lintian finds nothing to say of them. The tests are left to make check.
deb: dist
	@scripts/setup.sh $@
	@dpkg-parsechangelog -l debian/changelog -S Version | grep -q -x '$(VERSION)' || { \
		echo 'debian/changelog: expected version $(VERSION)' >&2; exit 1; }
	rm -rf $(BUILD)/deb && mkdir -p $(BUILD)/deb && tar -xzf $(BUILD)/stdfit-$(VERSION).tar.gz -C $(BUILD)/deb
	cd $(BUILD)/deb/stdfit-$(VERSION) && unset MAKEFLAGS MFLAGS BUILD && \
		DEB_BUILD_OPTIONS="nocheck $$DEB_BUILD_OPTIONS" dpkg-buildpackage --no-sign --build=full
	lintian --fail-on error,warning --allow-root $(BUILD)/deb/*.changes

.PHONY: library install uninstall dist deb
