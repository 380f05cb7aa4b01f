# cpack -G DEB makes Debian packages of a build with static libraries: libdlo-force-model-dev for
# programs that embed the force model, libdlo-dev for the other two libraries, the command dlo, and
# python3-dlo where the Python module is built; help2man makes the manual page of the command; dpkg-shlibdeps finds the libraries that these two need. Whoever gives them to others sets
# CPACK_PACKAGE_CONTACT to an address that answers.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the dlo authors <dlo@localhost>" CACHE STRING "Maintainer of the packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE
  GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own

# Files that Debian asks of each package and that no other installation has.
file(READ LICENSE licence)
string(REGEX REPLACE "^.*\n\n(Permission)" "\\1" licence "${licence}")
string(REGEX REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REGEX REPLACE "([^\n]+)" " \\1" licence "${licence}")
configure_file(${dlo_package_dir}/copyright.in copyright @ONLY)
configure_file(${dlo_package_dir}/changelog.in changelog @ONLY)
execute_process(COMMAND gzip -9nf changelog WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}
  COMMAND_ERROR_IS_FATAL ANY)

# dlo_debian(<package> COMPONENTS <install components> SECTION <section> DEPENDS <dependencies>
#   DESCRIPTION <summary and lines>): declares a package.
function(dlo_debian package)
  cmake_parse_arguments(PARSE_ARGV 1 "" "" "SECTION;DESCRIPTION" "COMPONENTS;DEPENDS")
  string(MAKE_C_IDENTIFIER ${package} group)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/copyright ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${package} COMPONENT ${group}_doc EXCLUDE_FROM_ALL)
  list(APPEND _COMPONENTS ${group}_doc)
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${_COMPONENTS} PARENT_SCOPE)
  foreach(component IN LISTS _COMPONENTS)
    string(TOUPPER ${component} COMPONENT)
    set(CPACK_COMPONENT_${COMPONENT}_GROUP ${group} PARENT_SCOPE)
  endforeach()
  string(TOUPPER ${group} GROUP)
  list(JOIN _DEPENDS ", " depends)
  set(CPACK_DEBIAN_${GROUP}_PACKAGE_NAME ${package} PARENT_SCOPE)
  set(CPACK_DEBIAN_${GROUP}_PACKAGE_SECTION ${_SECTION} PARENT_SCOPE)
  set(CPACK_DEBIAN_${GROUP}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${GROUP}_DESCRIPTION "${_DESCRIPTION}" PARENT_SCOPE)
endfunction()

dlo_debian(libdlo-force-model-dev COMPONENTS force_model SECTION libdevel
  DEPENDS "libeigen3-dev (>= 3.4)"
  DESCRIPTION "fast force-based model of rods, wires, ropes and cables
Points, inner forces and explicit steps, made for 1 kHz haptic loops. This
package contains the static libraries dlo::force_model and dlo::obstacle, their
headers, and files for CMake and pkg-config. They need Eigen only.")
dlo_debian(libdlo-dev COMPONENTS energy_model compare SECTION libdevel
  DEPENDS "libdlo-force-model-dev (= ${PROJECT_VERSION})" "libeigen3-dev (>= 3.4)"
    "libnlopt-dev (>= 2.7)" "libgsl-dev (>= 2.7)" "libtomlplusplus-dev (>= 3.3)"
    "libfmt-dev (>= 9)" "libpugixml-dev (>= 1.13)"
  DESCRIPTION "physical shapes of rods and comparison of rod models
The static libraries dlo::energy_model (shapes of minimal bending and gravity
energy) and dlo::compare (scenes, and how far the shapes of two models are
apart), their headers, among them matchers for GoogleTest, and files for CMake
and pkg-config.")
set(CPACK_DEBIAN_LIBDLO_DEV_PACKAGE_SUGGESTS libgtest-dev)
dlo_debian(dlo COMPONENTS command SECTION science
  DESCRIPTION "compares fast models of rods, wires and cables with physics
Solves scenes of rods held by grippers under gravity with a fast force-based
model and with the rod's bending and gravity energy, prints how far the shapes
are apart, why, and at what cost, checks the shapes of other simulators and
calibrates their parameters.")
set(CPACK_DEBIAN_DLO_PACKAGE_SHLIBDEPS ON)
if(TARGET dlo_python)
  # Of the Python that it was compiled for, and of no later one.
  string(REGEX MATCH "^([0-9]+)\\.([0-9]+)" python_version "${PYTHON_VERSION_STRING}")
  math(EXPR next_minor "${CMAKE_MATCH_2} + 1")
  dlo_debian(python3-dlo COMPONENTS python SECTION python
    DEPENDS "python3 (>= ${python_version})" "python3 (<< ${CMAKE_MATCH_1}.${next_minor})"
      "python3-numpy"
    DESCRIPTION "compares fast models of rods, wires and cables with physics, in Python
The module dlo: scenes from files or built in code, shapes, checks of other
simulators' points and calibration with NumPy arrays, and the force model in a
loop of one's own.")
  set(CPACK_DEBIAN_PYTHON3_DLO_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON3_DLO_PACKAGE_SUGGESTS python3-matplotlib)
endif()

include(CPack)
