/* The elements of a camera's description, as a sorted table. */
#include "drivers/genicam/elements.h"

#include <stdlib.h>
#include <string.h>

#define CONTAINER(element) {element, ELEMENT_CONTAINER, KIND_NONE, TAG_NONE, false}
#define NODE(element, kind) {element, ELEMENT_NODE, kind, TAG_NONE, false}
#define VALUE(element, tag) {element, ELEMENT_PROPERTY, KIND_NONE, tag, false}
#define REFERENCE(element, tag) {element, ELEMENT_PROPERTY, KIND_NONE, tag, true}

/* Sorted by name, as strcmp does. */
static const struct element table[] = {
    VALUE("AccessMode", TAG_ACCESS),
    VALUE("Address", TAG_ADDRESS),
    VALUE("Bit", TAG_BIT),
    NODE("Boolean", KIND_BOOLEAN),
    VALUE("Cachable", TAG_CACHABLE),
    NODE("Category", KIND_CATEGORY),
    VALUE("ChunkID", TAG_FOREIGN),
    NODE("Command", KIND_COMMAND),
    VALUE("CommandValue", TAG_COMMAND),
    VALUE("Constant", TAG_CONSTANT),
    NODE("Converter", KIND_CONVERTER),
    VALUE("Endianess", TAG_ENDIANNESS),
    VALUE("Endianness", TAG_ENDIANNESS),
    NODE("EnumEntry", KIND_ENUM_ENTRY),
    NODE("Enumeration", KIND_ENUMERATION),
    VALUE("EventID", TAG_FOREIGN),
    VALUE("Expression", TAG_EXPRESSION),
    NODE("Float", KIND_FLOAT),
    NODE("FloatReg", KIND_FLOAT_REG),
    VALUE("Formula", TAG_FORMULA),
    VALUE("FormulaFrom", TAG_FORMULA_FROM),
    VALUE("FormulaTo", TAG_FORMULA_TO),
    CONTAINER("Group"),
    VALUE("ImposedAccessMode", TAG_ACCESS),
    VALUE("Inc", TAG_STEP),
    NODE("IntConverter", KIND_INT_CONVERTER),
    NODE("IntReg", KIND_INT_REG),
    NODE("IntSwissKnife", KIND_INT_KNIFE),
    NODE("Integer", KIND_INTEGER),
    VALUE("LSB", TAG_LSB),
    VALUE("Length", TAG_LENGTH),
    VALUE("MSB", TAG_MSB),
    NODE("MaskedIntReg", KIND_MASKED_INT_REG),
    VALUE("Max", TAG_MAX),
    VALUE("Min", TAG_MIN),
    VALUE("OffValue", TAG_OFF),
    VALUE("OnValue", TAG_ON),
    VALUE("PollingTime", TAG_POLLING_TIME),
    NODE("Port", KIND_PORT),
    NODE("Register", KIND_REGISTER),
    CONTAINER("RegisterDescription"),
    VALUE("Sign", TAG_SIGN),
    VALUE("Slope", TAG_SLOPE),
    NODE("String", KIND_STRING),
    NODE("StringReg", KIND_STRING_REG),
    NODE("StructEntry", KIND_STRUCT_ENTRY),
    NODE("StructReg", KIND_STRUCT_REG),
    NODE("SwissKnife", KIND_KNIFE),
    VALUE("Unit", TAG_UNIT),
    VALUE("Value", TAG_VALUE),
    VALUE("ValueDefault", TAG_VALUE_DEFAULT),
    VALUE("ValueIndexed", TAG_VALUE_INDEXED),
    REFERENCE("pAddress", TAG_ADDRESS),
    REFERENCE("pChunkID", TAG_FOREIGN),
    REFERENCE("pCommandValue", TAG_COMMAND),
    REFERENCE("pFeature", TAG_FEATURE),
    REFERENCE("pInc", TAG_STEP),
    REFERENCE("pIndex", TAG_INDEX),
    REFERENCE("pIsAvailable", TAG_IS_AVAILABLE),
    REFERENCE("pIsImplemented", TAG_IS_IMPLEMENTED),
    REFERENCE("pIsLocked", TAG_IS_LOCKED),
    REFERENCE("pLength", TAG_LENGTH),
    REFERENCE("pMax", TAG_MAX),
    REFERENCE("pMin", TAG_MIN),
    REFERENCE("pPort", TAG_PORT),
    REFERENCE("pValue", TAG_VALUE),
    REFERENCE("pValueCopy", TAG_VALUE_COPY),
    REFERENCE("pValueDefault", TAG_VALUE_DEFAULT),
    REFERENCE("pValueIndexed", TAG_VALUE_INDEXED),
    REFERENCE("pVariable", TAG_VARIABLE),
};

static int compare(const void *key, const void *row) {
  return strcmp(key, ((const struct element *)row)->name);
}

const struct element *placido_genicam_element(const char *name) {
  const char *colon = strrchr(name, ':');
  return bsearch(colon ? colon + 1 : name, table, sizeof table / sizeof *table, sizeof *table,
                 compare);
}

bool placido_genicam_may_stand(enum kind kind, enum kind within, enum tag *tag) {
  *tag = TAG_NONE;
  if (kind == KIND_ENUM_ENTRY) {
    *tag = TAG_ENTRY;
    return within == KIND_ENUMERATION;
  }
  if (kind == KIND_STRUCT_ENTRY) {
    return within == KIND_STRUCT_REG;
  }
  const bool is_register = within >= KIND_INT_REG && within <= KIND_STRUCT_REG;
  if (is_register && (kind == KIND_INT_KNIFE || kind == KIND_KNIFE)) {
    *tag = TAG_ADDRESS;
    return true;
  }
  return within == KIND_NONE;
}
