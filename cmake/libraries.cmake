# What scree stands on, built from the sources of tools/library-sources.sh under the names of the packages.
enable_language(CXX)
set(sources ${SCREE_LIBRARY_SOURCES})

function(add_source_library name alias)
  add_library(${name} STATIC ${ARGN})
  set_target_properties(${name} PROPERTIES C_EXTENSIONS ON C_VISIBILITY_PRESET default)
  target_compile_options(${name} PRIVATE -w -O2 -ffp-contract=off)
  add_library(${alias} ALIAS ${name})
endfunction()

file(GLOB qhull ${sources}/qhull/src/libqhull_r/*_r.c)
add_source_library(qhull_sources Qhull::qhull_r ${qhull})
target_include_directories(qhull_sources PUBLIC ${sources}/qhull/src)

add_source_library(xxhash_sources PkgConfig::XXHASH ${sources}/xxhash/xxhash.c)
target_include_directories(xxhash_sources PUBLIC ${sources}/xxhash)

file(GLOB yaml ${sources}/libyaml/src/*.c)
add_source_library(yaml_sources PkgConfig::YAML ${yaml})
target_include_directories(yaml_sources PUBLIC ${sources}/libyaml/include)
target_compile_definitions(yaml_sources PUBLIC YAML_DECLARE_STATIC PRIVATE YAML_VERSION_MAJOR=0 YAML_VERSION_MINOR=2
  YAML_VERSION_PATCH=5 YAML_VERSION_STRING="0.2.5")

file(GLOB expat ${sources}/expat/expat/lib/xml*.c)
add_source_library(expat_sources PkgConfig::EXPAT ${expat})
target_include_directories(expat_sources PUBLIC ${sources}/expat/expat/lib PRIVATE ${CMAKE_BINARY_DIR}/expat)
target_compile_definitions(expat_sources PUBLIC XML_STATIC)
# No DTD is read, so that no table can be flooded by names that an attacker chooses but those of one element: the
# entropy of addresses and time does.
file(WRITE ${CMAKE_BINARY_DIR}/expat/expat_config.h
  "#define BYTEORDER 1234\n#define XML_NS 1\n#define XML_DTD 1\n#define XML_CONTEXT_BYTES 1024\n"
  "#define XML_POOR_ENTROPY 1\n#define HAVE_MEMMOVE 1\n#define HAVE_UNISTD_H 1\n")

file(GLOB zlib ${sources}/zlib/*.c)
list(FILTER zlib INCLUDE REGEX "/(adler32|crc32|inffast|inflate|inftrees|zutil)\\.c$") # what reads
add_source_library(zlib_sources PkgConfig::ZLIB ${zlib})
target_include_directories(zlib_sources PUBLIC ${sources}/zlib)

# Only what packs meshes for the report.
set(meshopt ${sources}/meshoptimizer/src)
add_source_library(meshopt_sources meshoptimizer::meshoptimizer ${meshopt}/allocator.cpp ${meshopt}/indexcodec.cpp
  ${meshopt}/indexgenerator.cpp ${meshopt}/vcacheoptimizer.cpp ${meshopt}/vertexcodec.cpp
  ${meshopt}/vfetchoptimizer.cpp)
target_compile_options(meshopt_sources PRIVATE -fno-exceptions -fno-rtti)
target_include_directories(meshopt_sources PUBLIC ${meshopt})

if(SCREE_STUDY)
  add_source_library(sqlite_sources PkgConfig::SQLITE ${sources}/sqlite/sqlite3.c)
  target_include_directories(sqlite_sources PUBLIC ${sources}/sqlite)
endif()
