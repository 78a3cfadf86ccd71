#include "report/program.h"

#include "base/path.h"

bool scree_product_is_made(const scree_product *product) {
  return scree_build_has(SCREE_BUILD_PICTURES) ||
         !(scree_ends_with(product->name, ".png") || scree_ends_with(product->name, ".svg") ||
           scree_ends_with(product->name, ".pdf"));
}

scree_status scree_products_write(const scree_product *products, size_t count, const void *result,
                                  const char *folder, bool overwrite, scree_error *error) {
  for (size_t i = 0; i < count; i++) {
    if (!scree_product_is_made(&products[i])) continue;
    scree_status status =
        products[i].write(result, SCREE_PATH_IN(folder, products[i].name), overwrite, error);
    if (status != SCREE_OK && status != SCREE_UNSUPPORTED) return status;
  }
  return SCREE_OK;
}
