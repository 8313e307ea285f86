//! Parsing a model part of a 3MF file.

use super::attributes::Attributes;
use super::model::{Instance, Model, ModelObject, Shape};
use super::package::{Package, Part, line_at};
use super::properties::{Group, Groups, Missing, NONE, Property};
use crate::formats::error::{FormatError, quote, shorten};
use crate::scene::{Color, Material, MeshData};
use glam::{DAffine3, DVec3};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::HashMap;

/// The parent of an element, which decides the meaning of the element's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Parent {
    Document,
    Model,
    Resources,
    BaseMaterials,
    ColorGroup,
    Object,
    Mesh,
    Vertices,
    Triangles,
    Components,
    Build,
    /// An ignored element, with all its children.
    Other,
}

/// Supported required extensions, by a part of their namespace.
const KNOWN: [&str; 5] = [
    "/core/",
    "/production/",
    "/material/",
    "/trianglesets/",
    "/beamlattice/",
];

/// An object while it is parsed.
#[derive(Default)]
struct Open {
    id: u32,
    name: Option<String>,
    /// The property of triangles without properties of their own.
    property: Property,
    mesh: Option<MeshData>,
    components: Vec<Instance>,
    /// One for each triangle; empty where no triangle has any.
    properties: Vec<Property>,
    line: usize,
}

/// The properties of an object's triangles, whose groups may follow later in the file.
struct Pending {
    object: u32,
    /// As in [`Open`].
    properties: Vec<Property>,
    line: usize,
}

struct ModelReader<'r, 'b> {
    attributes: Attributes<'r, 'b>,
    model: Model,
    open: Open,
    groups: Groups,
    group: u32,
    /// Objects whose properties are resolved at the end.
    pending: Vec<Pending>,
    unused: HashMap<&'static str, usize>,
    triangles: u64,
    triangles_left: u64,
}

/// Parses a model part of at most `triangles_left` triangles.
pub(super) fn read(
    package: &Package<'_>,
    part: &Part<'_>,
    triangles_left: u64,
) -> Result<Model, FormatError> {
    let mut reader = ModelReader {
        attributes: Attributes {
            package,
            part,
            line: 1,
        },
        model: Model::default(),
        open: Open::default(),
        groups: Groups::default(),
        group: 0,
        pending: Vec::new(),
        unused: HashMap::new(),
        triangles: 0,
        triangles_left,
    };
    reader.document()?;
    reader.finish()
}

impl ModelReader<'_, '_> {
    fn document(&mut self) -> Result<(), FormatError> {
        let text = &self.attributes.part.text[..];
        let mut reader = Reader::from_reader(text);
        let mut parents = vec![Parent::Document];
        // Lines are counted incrementally.
        let mut counted = 0;
        let mut has_model = false;
        loop {
            let event = reader.read_event();
            let at = (reader.buffer_position() as usize).clamp(counted, text.len());
            let parent = parents.last().copied().unwrap_or(Parent::Document);
            let event = match event {
                Ok(event) => event,
                Err(error) => {
                    self.attributes.line = line_at(text, reader.error_position());
                    return Err(self.attributes.fault(&shorten(&error.to_string())));
                }
            };
            match &event {
                Event::Start(tag) | Event::Empty(tag) => {
                    let inner = self.element(tag, parent)?;
                    has_model |= inner == Parent::Model;
                    if matches!(event, Event::Start(_)) {
                        parents.push(inner);
                    } else {
                        self.leave(inner);
                    }
                }
                Event::End(_) => {
                    parents.pop();
                    self.leave(parent);
                }
                Event::Eof => {
                    self.attributes.line += memchr::memchr_iter(b'\n', &text[counted..at]).count();
                    if parents.len() > 1 {
                        return Err(self
                            .attributes
                            .unexpected("the end of its elements", "the part's end"));
                    }
                    break;
                }
                _ => {}
            }
            self.attributes.line += memchr::memchr_iter(b'\n', &text[counted..at]).count();
            counted = at;
        }
        if has_model {
            Ok(())
        } else {
            Err(self.attributes.unexpected("a model", "none"))
        }
    }

    /// Parses an element's tag; returns the parent of the elements in it.
    fn element(&mut self, tag: &BytesStart<'_>, parent: Parent) -> Result<Parent, FormatError> {
        let name = tag.local_name();
        Ok(match (parent, name.as_ref()) {
            (Parent::Document, b"model") => {
                self.start_model(tag)?;
                Parent::Model
            }
            (Parent::Model, b"resources") => Parent::Resources,
            (Parent::Model, b"build") => Parent::Build,
            (Parent::Build, b"item") => {
                let item = self.instance(tag)?;
                self.model.items.push(item);
                Parent::Other
            }
            (Parent::Resources, b"basematerials" | b"colorgroup") => {
                self.group = self.attributes.need(tag, b"id")?;
                let is_interpolated = name.as_ref() == b"colorgroup";
                let group = Group {
                    members: Vec::new(),
                    is_interpolated,
                };
                self.groups.shown.insert(self.group, group);
                if is_interpolated {
                    Parent::ColorGroup
                } else {
                    Parent::BaseMaterials
                }
            }
            (Parent::BaseMaterials, b"base") => {
                let name = self.attributes.text(tag, b"name")?;
                self.color(tag, b"displaycolor", name)?;
                Parent::Other
            }
            (Parent::ColorGroup, b"color") => {
                self.color(tag, b"color", None)?;
                Parent::Other
            }
            (Parent::Resources, b"texture2dgroup" | b"compositematerials" | b"multiproperties") => {
                let id = self.attributes.need(tag, b"id")?;
                self.groups.others.insert(id);
                *self
                    .unused
                    .entry("groups of textures or mixtures")
                    .or_default() += 1;
                Parent::Other
            }
            (Parent::Resources, b"object") => {
                let id = self.attributes.need(tag, b"id")?;
                if self.model.objects.contains_key(&id) {
                    let found = format!("{id} once more");
                    return Err(self
                        .attributes
                        .unexpected("a number that no other object has", &found));
                }
                self.open = Open {
                    id,
                    name: self
                        .attributes
                        .text(tag, b"name")?
                        .filter(|name| !name.is_empty()),
                    property: Property {
                        group: self.attributes.number(tag, b"pid")?.unwrap_or(NONE),
                        members: [self.attributes.number(tag, b"pindex")?.unwrap_or(0); 3],
                    },
                    line: self.attributes.line,
                    ..Open::default()
                };
                Parent::Object
            }
            (Parent::Object, b"mesh") => {
                self.open.mesh.get_or_insert_default();
                Parent::Mesh
            }
            (Parent::Object, b"components") => Parent::Components,
            (Parent::Components, b"component") => {
                let component = self.instance(tag)?;
                self.open.components.push(component);
                Parent::Other
            }
            (Parent::Mesh, b"vertices") => Parent::Vertices,
            (Parent::Mesh, b"triangles") => Parent::Triangles,
            (Parent::Mesh, b"beamlattice") => {
                *self.unused.entry("lattices of beams").or_default() += 1;
                Parent::Other
            }
            (Parent::Vertices, b"vertex") => {
                let position = self.vertex(tag)?;
                if let Some(mesh) = &mut self.open.mesh {
                    mesh.positions.push(position);
                }
                Parent::Other
            }
            (Parent::Triangles, b"triangle") => {
                self.triangle(tag)?;
                Parent::Other
            }
            _ => Parent::Other,
        })
    }

    /// Closes an element.
    fn leave(&mut self, parent: Parent) {
        if parent != Parent::Object {
            return;
        }
        let Open {
            id,
            name,
            mesh,
            components,
            properties,
            line,
            ..
        } = std::mem::take(&mut self.open);
        if !properties.is_empty() {
            self.pending.push(Pending {
                object: id,
                properties,
                line,
            });
        }
        let shape = match mesh {
            Some(mesh) => Shape::Mesh(Box::new(mesh)),
            None => Shape::Components(components),
        };
        self.model.objects.insert(id, ModelObject { name, shape });
    }

    fn start_model(&mut self, tag: &BytesStart<'_>) -> Result<(), FormatError> {
        let unit = self.attributes.text(tag, b"unit")?;
        self.model.unit = unit.unwrap_or_else(|| "millimeter".to_owned());
        let required = self
            .attributes
            .text(tag, b"requiredextensions")?
            .unwrap_or_default();
        for prefix in required.split_whitespace() {
            let mut namespace = String::new();
            for attribute in tag.attributes().with_checks(false).flatten() {
                if attribute.key.as_ref().strip_prefix(b"xmlns:") == Some(prefix.as_bytes()) {
                    namespace = String::from_utf8_lossy(&attribute.value).into_owned();
                }
            }
            if !KNOWN.iter().any(|known| namespace.contains(known)) {
                let found = if namespace.is_empty() {
                    prefix
                } else {
                    &namespace
                };
                let expected = "no extensions that it needs but those that are read";
                return Err(self.attributes.unexpected(expected, &quote(found)));
            }
        }
        Ok(())
    }

    fn vertex(&self, tag: &BytesStart<'_>) -> Result<DVec3, FormatError> {
        let mut position = [None; 3];
        for attribute in tag.attributes().with_checks(false) {
            let attribute = attribute.map_err(|error| self.attributes.fault(&error.to_string()))?;
            let axis = match attribute.key.as_ref() {
                b"x" => 0,
                b"y" => 1,
                b"z" => 2,
                _ => continue,
            };
            position[axis] = Some(self.attributes.parse(&attribute.value, "a number")?);
        }
        match position {
            [Some(x), Some(y), Some(z)] => Ok(DVec3::new(x, y, z)),
            _ => Err(self
                .attributes
                .unexpected("a vertex with x, y and z", "one without")),
        }
    }

    fn triangle(&mut self, tag: &BytesStart<'_>) -> Result<(), FormatError> {
        let mut corners = [None; 3];
        let mut group = None;
        let mut indices: [Option<u32>; 3] = [None; 3];
        for attribute in tag.attributes().with_checks(false) {
            let attribute = attribute.map_err(|error| self.attributes.fault(&error.to_string()))?;
            let whole = || self.attributes.parse(&attribute.value, "a whole number");
            match attribute.key.as_ref() {
                b"v1" => corners[0] = Some(whole()?),
                b"v2" => corners[1] = Some(whole()?),
                b"v3" => corners[2] = Some(whole()?),
                b"pid" => group = Some(whole()?),
                b"p1" => indices[0] = Some(whole()?),
                b"p2" => indices[1] = Some(whole()?),
                b"p3" => indices[2] = Some(whole()?),
                _ => {}
            }
        }
        let [Some(a), Some(b), Some(c)] = corners else {
            return Err(self
                .attributes
                .unexpected("a triangle with v1, v2 and v3", "one without"));
        };
        self.triangles += 1;
        if self.triangles > self.triangles_left {
            let most = self.triangles_left;
            return Err(self.attributes.fault(&format!(
                "it has more triangles than the {most} that are left"
            )));
        }
        let own = self.open.property;
        let property = match indices {
            [Some(first), second, third] => Property {
                group: group.unwrap_or(own.group),
                members: [first, second.unwrap_or(first), third.unwrap_or(first)],
            },
            _ => own,
        };
        let Some(mesh) = &mut self.open.mesh else {
            return Ok(());
        };
        let vertices = mesh.positions.len();
        if let Some(outside) = [a, b, c]
            .into_iter()
            .find(|&v: &u32| v as usize >= vertices)
        {
            let expected = format!("the number of one of {vertices} vertices");
            return Err(self.attributes.unexpected(&expected, &outside.to_string()));
        }
        let before = mesh.triangles.len();
        mesh.triangles.push([a, b, c]);
        if property.group != NONE || !self.open.properties.is_empty() {
            self.open.properties.resize(before, Property::default());
            self.open.properties.push(property);
        }
        Ok(())
    }

    fn color(
        &mut self,
        tag: &BytesStart<'_>,
        key: &[u8],
        name: Option<String>,
    ) -> Result<(), FormatError> {
        let Some(text) = self.attributes.text(tag, key)? else {
            return Err(self
                .attributes
                .unexpected("a colour as #RRGGBB or #RRGGBBAA", "none"));
        };
        let (opaque, alpha) = match text.len() {
            9 if text.is_ascii() => text.split_at(7),
            _ => (&*text, "FF"),
        };
        let color: Color = match opaque.parse() {
            Ok(color) if opaque.starts_with('#') && opaque.len() == 7 => color,
            _ => {
                return Err(self
                    .attributes
                    .unexpected("a colour as #RRGGBB or #RRGGBBAA", &quote(&text)));
            }
        };
        if !alpha.eq_ignore_ascii_case("FF") {
            *self.unused.entry("opacity of colours").or_default() += 1;
        }
        let Group { members, .. } = self.groups.shown.entry(self.group).or_default();
        let name = name.unwrap_or_else(|| format!("color {}", members.len()));
        members.push(Material::new(name, color));
        Ok(())
    }

    fn instance(&self, tag: &BytesStart<'_>) -> Result<Instance, FormatError> {
        let outer_from_object = match self.attributes.text(tag, b"transform")? {
            Some(text) => self.attributes.transform(&text)?,
            None => DAffine3::IDENTITY,
        };
        Ok(Instance {
            part: self.attributes.text(tag, b"path")?,
            object: self.attributes.need(tag, b"objectid")?,
            outer_from_object,
            line: self.attributes.line,
        })
    }

    /// Gives triangles their materials, once all groups are known.
    fn finish(mut self) -> Result<Model, FormatError> {
        for pending in std::mem::take(&mut self.pending) {
            let Pending {
                object: id,
                properties,
                line,
            } = pending;
            let Some(object) = self.model.objects.get_mut(&id) else {
                continue;
            };
            let Shape::Mesh(mesh) = &mut object.shape else {
                continue;
            };
            self.attributes.line = line;
            match self.groups.give(properties, mesh) {
                Ok(mixed) => self.model.mixed += mixed,
                Err(missing) => {
                    let (expected, found) = match missing {
                        Missing::Group(group) => (
                            "groups of colours or materials".to_owned(),
                            group.to_string(),
                        ),
                        Missing::Member {
                            group,
                            index,
                            members,
                        } => (
                            format!("one of group {group}'s {members} colours"),
                            format!("number {index}"),
                        ),
                    };
                    let expected = format!("object {id} to name {expected}");
                    return Err(self.attributes.unexpected(&expected, &found));
                }
            }
        }
        self.model.unused = self.unused.into_iter().collect();
        self.model.unused.sort_unstable();
        Ok(self.model)
    }
}
