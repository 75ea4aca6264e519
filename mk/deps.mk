# Debian packages that the build and the experiment need.

DEBIAN_PACKAGES := g++ make pkg-config ca-certificates \
  libode-dev libeigen3-dev libassimp-dev libpcl-dev libccd-dev libhdf5-dev libosmesa6-dev \
  libdnnl-dev libcli11-dev libspdlog-dev libfmt-dev libtomlplusplus-dev liburdfdom-dev \
  liburdfdom-headers-dev libqhull-dev libpng-dev libfreetype-dev libxxhash-dev libgtest-dev libgmock-dev \
  libbenchmark-dev libhwy-dev libopenmpi-dev openmpi-bin gnuplot-nox fonts-dejavu-core ffmpeg libarchive-tools

# Taken where they can be had: a few percent of speed, and the referee of the physics engines.
OPTIONAL_PACKAGES := clang libmujoco-dev

.PHONY: deps
deps:  ## install the Debian packages that are missing (or print the line that does)
	@missing=$$(for p in $(DEBIAN_PACKAGES); do \
	    dpkg-query -W -f='$${Status}' $$p 2>/dev/null | grep -q 'ok installed' || echo $$p; done); \
	if [ -n "$$missing" ]; then \
	  if [ "$$(id -u)" = 0 ]; then run=; elif sudo -n true 2>/dev/null; then run=sudo; \
	  else echo "Please install what is missing, then run make again:"; \
	       echo "  sudo apt-get install --no-install-recommends" $$missing; exit 1; fi; \
	  $$run apt-get update; \
	  DEBIAN_FRONTEND=noninteractive $$run apt-get install -y --no-install-recommends $$missing; \
	  for p in $(OPTIONAL_PACKAGES); do \
	    DEBIAN_FRONTEND=noninteractive $$run apt-get install -y --no-install-recommends $$p || \
	      echo "Going on without $$p."; done; \
	fi
