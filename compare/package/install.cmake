# Installing. Each library is an install component and an export set of its own, so that one can be
# installed, and found, without what the others need. `force_model` also holds what all share.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(dlo_package_dir ${CMAKE_CURRENT_LIST_DIR})
set(dlo_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/dlo)
set(dlo_data_dir ${CMAKE_INSTALL_DATADIR}/dlo)
file(RELATIVE_PATH dlo_bin_to_lib /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})

# Installs the library dlo_<name> for find_package and pkg-config.
#   DESCRIPTION  for pkg-config
#   COMPONENT    of the installation, <name> if not given
#   FIND         what find_package has to find first, one "package version" each
#   REQUIRES     the same for pkg-config, one "package >= version" each
#   STATIC_FIND, STATIC_REQUIRES, STATIC_LIBS
#                what a program has to link besides a static library, and not besides a shared one;
#                public in the .pc file, so that pkg-config gives a line that links without --static
function(dlo_install name)
  cmake_parse_arguments(PARSE_ARGV 1 "" "" "DESCRIPTION;COMPONENT"
    "FIND;REQUIRES;STATIC_FIND;STATIC_REQUIRES;STATIC_LIBS")
  if(NOT _COMPONENT)
    set(_COMPONENT ${name})
  endif()
  if(NOT BUILD_SHARED_LIBS)
    list(APPEND _FIND ${_STATIC_FIND})
    list(APPEND _REQUIRES ${_STATIC_REQUIRES})
  else()
    set(_STATIC_LIBS)
  endif()

  install(TARGETS dlo_${name} EXPORT dlo_${name}
    ARCHIVE COMPONENT ${_COMPONENT} LIBRARY COMPONENT ${_COMPONENT} RUNTIME COMPONENT ${_COMPONENT}
    FILE_SET HEADERS COMPONENT ${_COMPONENT})

  install(EXPORT dlo_${name} NAMESPACE dlo:: FILE dlo_${name}-targets.cmake
    DESTINATION ${dlo_cmake_dir} COMPONENT ${_COMPONENT})
  list(TRANSFORM _FIND REPLACE ".+" "find_dependency(\\0)")
  list(JOIN _FIND "\n" find_dependencies)
  configure_file(${dlo_package_dir}/library.cmake.in dlo_${name}.cmake @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/dlo_${name}.cmake
    DESTINATION ${dlo_cmake_dir} COMPONENT ${_COMPONENT})

  string(REPLACE _ - pkgconfig_name dlo-${name})
  list(JOIN _REQUIRES ", " requires)
  list(JOIN _STATIC_LIBS " " static_libs)
  list(TRANSFORM dlo_eigen_memory PREPEND -D OUTPUT_VARIABLE defines)
  list(JOIN defines " " defines)
  string(REGEX REPLACE "[^/]+" ".." to_prefix ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
  configure_file(${dlo_package_dir}/library.pc.in ${pkgconfig_name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${pkgconfig_name}.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT ${_COMPONENT})
endfunction()

configure_package_config_file(${dlo_package_dir}/dloConfig.cmake.in dloConfig.cmake
  INSTALL_DESTINATION ${dlo_cmake_dir} PATH_VARS dlo_data_dir)
write_basic_package_version_file(dloConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/dloConfig.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/dloConfigVersion.cmake
  DESTINATION ${dlo_cmake_dir} COMPONENT force_model)

install(FILES LICENSE README.md CHANGELOG.md CONTRIBUTING.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT command)
foreach(folder obstacle force_model energy_model compare compare/python data tests)  # to which README.md leads
  install(FILES ${folder}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder} COMPONENT command)
endforeach()
install(DIRECTORY doc DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT command
  PATTERN "*.py" EXCLUDE PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY compare/doc DESTINATION ${CMAKE_INSTALL_DOCDIR}/compare COMPONENT command)
install(DIRECTORY compare/python/examples DESTINATION ${CMAKE_INSTALL_DOCDIR}/compare/python
  COMPONENT command)
install(FILES data/materials.toml data/effective_modulus.csv data/simulators.toml
  DESTINATION ${dlo_data_dir} COMPONENT command)
install(DIRECTORY data/scenes data/shapes data/mujoco data/suite DESTINATION ${dlo_data_dir} COMPONENT command)
