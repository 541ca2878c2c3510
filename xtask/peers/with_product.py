"""A STEP file with a product for what stands in it without one, so that readers that start at products find it.

usage: with_product.py FILE OUT
Solids, shell models and trimmed surfaces that no representation holds get one each, faces alone a shell model; every
representation of geometry gets a product and a shape definition. Nothing that is in the file is changed.
"""

import re
import sys

HOLDERS = {
    "MANIFOLD_SOLID_BREP": "ADVANCED_BREP_SHAPE_REPRESENTATION",
    "FACETED_BREP": "FACETED_BREP_SHAPE_REPRESENTATION",
    "SHELL_BASED_SURFACE_MODEL": "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
    "RECTANGULAR_TRIMMED_SURFACE": "GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION",
}


def appended(text):
    found = re.findall(r"#(\d+)\s*=\s*(.*?);\s*(?=#|ENDSEC)", text, re.S)
    records = {int(number): body for number, body in found}
    kinds = {number: re.match(r"\(?\s*(!?\w+)", body).group(1) for number, body in records.items()}
    lines = []

    def add(body):
        number = max(records) + 1000 + len(lines)
        lines.append(f"#{number}={body};")
        return number

    def of_kinds(wanted):
        return [number for number, kind in kinds.items() if kind in wanted]

    context = next((n for n, body in records.items() if "GLOBAL_UNIT_ASSIGNED_CONTEXT" in body), None)
    if context is None:
        length = add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
        angle = add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        context = add(
            f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle}))"
            "REPRESENTATION_CONTEXT('',''))"
        )
    held = of_kinds(set(HOLDERS.values()))
    if not held:
        held = [add(f"{HOLDERS[kinds[n]]}('',(#{n}),#{context})") for n in of_kinds(HOLDERS)]
    if not held:
        faces = ",".join(f"#{n}" for n in of_kinds({"ADVANCED_FACE", "FACE_SURFACE"}))
        shell = add(f"OPEN_SHELL('',({faces}))")
        model = add(f"SHELL_BASED_SURFACE_MODEL('',(#{shell}))")
        held = [add(f"MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#{model}),#{context})")]
    application = add("APPLICATION_CONTEXT('automotive design')")
    add(f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{application})")
    product_context = add(f"PRODUCT_CONTEXT('',#{application},'mechanical')")
    design = add(f"PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')")
    for number in held:
        product = add(f"PRODUCT('{number}','{number}','',(#{product_context}))")
        formation = add(f"PRODUCT_DEFINITION_FORMATION('','',#{product})")
        definition = add(f"PRODUCT_DEFINITION('','',#{formation},#{design})")
        shape = add(f"PRODUCT_DEFINITION_SHAPE('','',#{definition})")
        add(f"SHAPE_DEFINITION_REPRESENTATION(#{shape},#{number})")
    end = text.rindex("ENDSEC")
    return text[:end] + "\n".join(lines) + "\n" + text[end:]


def main(source, out):
    with open(source, encoding="latin-1") as file:
        text = file.read()
    with open(out, "w", encoding="latin-1") as file:
        file.write(appended(text))


main(*sys.argv[1:])
