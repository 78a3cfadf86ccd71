# make install: library, header, program, pkg-config and CMake package files.
include(CMakePackageConfigHelpers)

# libscree.a is shipped with the names of what it stands on: pkg-config --static lists them.
install(TARGETS scree RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
if(BUILD_SHARED_LIBS)
  install(TARGETS scree_shared EXPORT screeTargets
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT screeTargets NAMESPACE scree:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/scree)
endif()
install(TARGETS scree_static ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
# The parts have their own header folders, so that a program sees what is in them.
function(install_part part requires libs description)
  set(headers ${ARGN})
  set(SCREE_PART ${part})
  set(SCREE_PART_REQUIRES "${requires}")
  set(SCREE_PART_LIBS "${libs}")
  set(SCREE_PART_DESCRIPTION "${description}")
  configure_file(cmake/part.pc.in ${CMAKE_BINARY_DIR}/${part}.pc @ONLY)
  set(lines "/* ${description} */\n#pragma once\n\n")
  foreach(header ${headers})
    string(APPEND lines "#include \"scree/${header}.h\"\n")
    install(FILES include/scree/${header}.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${part}/scree)
  endforeach()
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/${part}/scree.h CONTENT "${lines}" @ONLY)
  install(FILES ${CMAKE_BINARY_DIR}/${part}/scree.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${part})
  install(FILES ${CMAKE_BINARY_DIR}/${part}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()
install(FILES ${CMAKE_BINARY_DIR}/libscree-mesh.a ${CMAKE_BINARY_DIR}/libscree-dem.a DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(FILES include/scree.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY include/scree DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

if(BUILD_SHARED_LIBS)
  configure_package_config_file(cmake/screeConfig.cmake.in ${CMAKE_BINARY_DIR}/screeConfig.cmake
                                INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/scree)
  write_basic_package_version_file(${CMAKE_BINARY_DIR}/screeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_BINARY_DIR}/screeConfig.cmake ${CMAKE_BINARY_DIR}/screeConfigVersion.cmake
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/scree)
endif()

if(embree_FOUND)
  set(SCREE_EMBREE_LIBS -lembree${embree_VERSION_MAJOR})
endif()
if(SCREE_PICTURES)
  string(APPEND SCREE_PC_REQUIRES "cairo ")
endif()
if(SCREE_STUDY)
  string(APPEND SCREE_PC_REQUIRES "sqlite3")
endif()
# The prefix from where the file lies, so that an installation may be moved.
file(RELATIVE_PATH SCREE_PC_PREFIX ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
install_part(scree-mesh "expat zlib" "-lqhull_r" "scans: read, check, repair, measure, simplify, choose, clump"
             base mesh measure check simplify fidelity choice sample particle clump)
install_part(scree-dem "" "" "DEM of polyhedra and clumps: particles and worlds" base mesh simplify particle world)
configure_file(cmake/scree.pc.in ${CMAKE_BINARY_DIR}/scree.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/scree.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# Man pages and completions come from the program's own option tables.
if(NOT CMAKE_CROSSCOMPILING) # the program cannot be run here otherwise
  set(completions)
  foreach(shell bash zsh fish)
    set(file ${CMAKE_BINARY_DIR}/completion/scree.${shell})
    add_custom_command(OUTPUT ${file} COMMAND sh -c [["$1" help --completion $2 > "$3"]] sh $<TARGET_FILE:scree> ${shell} ${file}
                       DEPENDS scree VERBATIM)
    list(APPEND completions ${file})
  endforeach()
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/completion ${CMAKE_BINARY_DIR}/man)
  add_custom_target(completion ALL DEPENDS ${completions})
  set(data ${CMAKE_INSTALL_DATADIR})
  install(FILES ${CMAKE_BINARY_DIR}/completion/scree.bash DESTINATION ${data}/bash-completion/completions RENAME scree)
  install(FILES ${CMAKE_BINARY_DIR}/completion/scree.zsh DESTINATION ${data}/zsh/site-functions RENAME _scree)
  install(FILES ${CMAKE_BINARY_DIR}/completion/scree.fish DESTINATION ${data}/fish/vendor_completions.d)
  find_program(SCDOC scdoc)
endif()
if(SCDOC AND NOT CMAKE_CROSSCOMPILING)
  set(pages)
  foreach(verb "" ${verbs})
    string(REGEX REPLACE "-$" "" page "scree-${verb}")
    set(file ${CMAKE_BINARY_DIR}/man/${page}.1)
    add_custom_command(OUTPUT ${file} COMMAND sh -c [["$1" help --man $2 | "$3" > "$4"]] sh $<TARGET_FILE:scree> "${verb}" ${SCDOC} ${file}
                       DEPENDS scree VERBATIM)
    list(APPEND pages ${file})
  endforeach()
  add_custom_target(man ALL DEPENDS ${pages})
  install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
endif()

# The Python module, over the shared library. Debian's Python looks into lib/python3.N/dist-packages below
# /usr/local, and into lib/python3/dist-packages below /usr.
find_program(SCREE_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(SCREE_PYTHON)
  execute_process(COMMAND ${SCREE_PYTHON} -c "import sys; print('%d.%d' % sys.version_info[:2])"
                  OUTPUT_VARIABLE python_version OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
set(SCREE_PYTHON_DIR lib/python${python_version}/dist-packages CACHE STRING "Where the Python module is installed")
install(DIRECTORY python/scree DESTINATION ${SCREE_PYTHON_DIR} FILES_MATCHING PATTERN "*.py" PATTERN py.typed)
install(FILES VERSION DESTINATION ${SCREE_PYTHON_DIR}/scree)
install(DIRECTORY include/scree DESTINATION ${SCREE_PYTHON_DIR}/scree/include) # which it reads the interface from
